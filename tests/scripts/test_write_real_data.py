"""The tables of docs/real_data.md: what is in them, and that they are those of the script."""

from pathlib import Path

from isa_ros.analysis.measured.against import Against
from isa_ros.analysis.measured.closing import Closed, Free
from isa_ros.analysis.measured.fit import Fit
import numpy as np
import pytest
from scripts import write_real_data
from scripts.write_real_data import OWN, own_lines, own_run, PAGE, record_lines, RECORDS, TRUE


def found(value: float, half_width: float) -> Against:
    free = Free('load.inertia', 50.0, 1.0, 200.0, 50.0, 'kg')
    return Against(
        'ram', False, {}, {}, {'position': Fit(0.5, 0.0, 1.0, 0.1, 99), 'force': 'constant'},
        [Closed(free, value, half_width)], {},
        {'position': Fit(0.0625, 0.0, 1.0, 0.1, 99), 'force': 'constant'})


def test_a_row_has_what_is_true_and_what_is_found() -> None:
    lines = own_lines(found(64.25, 1.5))
    assert lines[2] == '| `load.inertia`, kg | 50 | 65 | 64.25 | 62.8 to 65.8 |'
    assert lines[4] == '| signal | NRMSE before | NRMSE after |'
    assert lines[6:] == ['| position | 0.5 | 0.0625 |', '| force | constant | constant |']
    assert own_lines(found(64.25, 300.0))[2].endswith('| 64.25 | not determined |')


@pytest.mark.slow
def test_the_inertia_of_our_own_machine_is_found() -> None:
    """Its measurement has all of `TRUE`; one parameter alone is sought."""
    own, = own_run(1.0, ['load.inertia']).parameters
    assert own.free.start == 50.0 and own.value == pytest.approx(TRUE['load.inertia'], abs=3.0)


def record(path: Path, header: str, columns: list[np.ndarray]) -> None:
    np.savetxt(path, np.stack(columns, axis=1), '%.6f', '\t', header=header, comments='')


@pytest.mark.slow
def test_every_pair_of_records_has_its_rows(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Made records: the press is 20 ms late with half of the motion, one rotary is the other."""
    t = np.arange(1500) * 1e-3
    sweep = np.sin(2 * np.pi * 2.0 * t)
    late = 0.5 * np.sin(2 * np.pi * 2.0 * (t - 0.02))
    record(tmp_path / 'mts_damper.txt', '\n' * 6 + 'CHANNEL0\tCHANNEL1\tCHANNEL2',
           [0.2 * late, late, 0.2 * sweep])
    for name, gain in (('rotary_1', 1.0), ('rotary_2', 0.75)):
        record(tmp_path / f'{name}.txt', 'PG_1\tPG_2\tAngle',
               [gain * sweep, 3.0 - sweep, 2.0 + sweep])
    monkeypatch.setattr(write_real_data, 'PRESS_S', 0.5)
    monkeypatch.setattr(write_real_data, 'LOOP', ('reu.position.stiffness',))
    rows = [line.strip('| ').split(' | ') for line in record_lines(tmp_path)[2:]]
    assert [row[:3] for row in rows] == [
        ['its command', 'the press', 'position'],
        ['the press, 25 s', 'a model, assumed', 'position'],
        ['the press, 25 s', 'a model, assumed', 'force'],
        ['the press, 25 s', 'the model, its position loop free', 'position'],
        ['the press, 25 s', 'the model, its position loop free', 'force'],
        *(['rotary actuator 1', 'rotary actuator 2', name]
          for name in ('pressure_a', 'pressure_b', 'position'))]
    assert rows[0][4] == '20.00 ms' and float(rows[0][5]) == pytest.approx(0.5, abs=0.005)
    assert float(rows[5][5]) == pytest.approx(0.75, abs=1e-3)
    assert float(rows[3][3]) < float(rows[1][3])


def test_the_parts_of_the_page_are_written(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    """Without a directory that of the records stays."""
    page = tmp_path / 'real_data.md'
    page.write_text(PAGE.read_text(encoding='utf-8'), encoding='utf-8')
    monkeypatch.setattr(write_real_data, 'PAGE', page)
    monkeypatch.setattr(write_real_data, 'own_run', lambda duration: found(64.25, duration))
    monkeypatch.setattr(write_real_data, 'record_lines', lambda folder: [f'from {folder}'])
    assert write_real_data.main([]) == 0 and capsys.readouterr().out == f'{page}\n'
    assert '| 64.25 | 60.2 to 68.2 |' in page.read_text()
    assert '| rotary actuator 1 | rotary actuator 2 | position |' in page.read_text()
    assert write_real_data.main(['records']) == 0
    assert 'from records' in page.read_text()


def test_the_page_has_every_parameter_and_pair() -> None:
    page = PAGE.read_text(encoding='utf-8')
    own = page.split(f'<!-- {OWN} -->')[1].split('<!-- end -->')[0]
    assert [name in own for name in TRUE] == [True] * len(TRUE)
    assert page.split(f'<!-- {RECORDS} -->')[1].split('<!-- end -->')[0].count('\n|') == 10
