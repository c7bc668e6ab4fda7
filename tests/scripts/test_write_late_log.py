"""The table of docs/real_data.md about late logs: its cells, and that it is that of the script."""

from collections.abc import Sequence
from pathlib import Path

from isa_ros.analysis.measured.closing import Closed, Free, MACHINE
import pytest
from scripts import write_late_log
from scripts.write_late_log import PAGE, row, searched


def closed(key: str, value: float, half_width: float) -> Closed:
    return Closed(Free(key, 1.0, 0.0, 2.0, 1.0, ''), value, half_width)


@pytest.mark.parametrize(('value', 'expected'), [
    (64.5, '64.5 +- 0.75'), (65.5, '65.5 +- 0.75'), (64.0, '**64 +- 0.75**'),
    (66.0, '**66 +- 0.75**')])
def test_an_interval_beside_the_true_value_is_bold(value: float, expected: str) -> None:
    found = [closed('load.inertia', value, 0.75), closed('delay_ms', 1.5, 0.25)]
    assert row(2.0, found) == ['2 ms', '**1.5 +- 0.25**', expected, 'not free', 'not free']
    assert row(1.5, found)[:2] == ['1.5 ms', '1.5 +- 0.25']


@pytest.mark.slow
def test_the_log_is_late(monkeypatch: pytest.MonkeyPatch) -> None:
    """The delay alone is sought, of a machine that has the other values: less is left of it."""
    monkeypatch.setattr(write_late_log, 'DURATION_S', 1.0)
    early, late = (searched(own, ['delay_ms'])[0].value for own in (0.0, 2.0))
    assert late - early == pytest.approx(2.0, abs=0.2)


def test_the_part_of_the_page_is_written(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / 'real_data.md'
    page.write_text(PAGE.read_text(encoding='utf-8'), encoding='utf-8')

    def made(delay_ms: float, free: Sequence[str]) -> list[Closed]:
        return [closed(key, 0.5 + delay_ms, 0.25) for key in free]
    monkeypatch.setattr(write_late_log, 'PAGE', page)
    monkeypatch.setattr(write_late_log, 'searched', made)
    assert write_late_log.main() == 0
    *rows, last = capsys.readouterr().out.splitlines()
    assert last == str(page) and len(rows) == 6
    text = page.read_text()
    assert '| 2 ms | **2.5 +- 0.25** | **2.5 +- 0.25** |' in text
    assert text.count('| 1 ms | ') == 2 and '| 0 ms | not free | ' in text
    assert all(f'`{key}`, ' in text for key in MACHINE)
