"""Times and values in SI are finite, and no gap in them makes an endless simulation."""

from pathlib import Path

from isa_ros.analysis.measured.mapping import load_mapping
from isa_ros.analysis.measured.measurement import (
    _refuse_gaps, Measurement, read_measurement)
from isa_ros.analysis.signals.signals import Signal
from isa_ros.errors import BagError
import numpy as np
import pytest


def measurement(
        tmp_path: Path, rows: str, position: str = '', time: str = '{column: t}') -> Measurement:
    (tmp_path / 'data.csv').write_text('t,x,s\n' + rows)
    (tmp_path / 'map.yaml').write_text(
        f'time: {time}\nsignals:\n  position: {{column: x, unit: mm{position}}}\n'
        '  position_command: {column: s, unit: mm}\n')
    return read_measurement(tmp_path / 'data.csv', load_mapping(tmp_path / 'map.yaml'), False)


def rows(t: object) -> str:
    return ''.join(f'{each},2,3\n' for each in np.asarray(t).tolist())


@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('rows, position, time, expected', [
    ('0,50,1\n1,-60,2\n', ', scale: 1.0e+308', '{column: t}',
     'position: sample 1 is 50, in SI inf, must be finite'),
    ('0,0,1\n1,6,2\n', ', scale: 1.0e+308, offset: 1.0e+308', '{column: t}',
     'position: sample 2 is 6, in SI inf, must be finite'),
    ('0,1,1\n1,inf,2\n', '', '{column: t}', 'position: sample 2 is inf, in SI inf, must be'),
    ('0,1,1\n1,2,2\ninf,3,3\n', '', '{column: t}',
     'position: the time of sample 3 is inf s, must be finite'),
    ('0,1,1\nnan,2,2\n3,3,3\n', '', '{column: t}',
     'position: the time of sample 2 is nan s, must be finite'),
    ('inf,1,1\n1,2,2\n', '', '{column: t}', 'position: the time of sample 1 is nan s, must be'),
    ('0,1,1\n1,2,2\n', '', '{rate_hz: 5.0e-324}',
     'position: the time of sample 2 is inf s, must be finite'),
    ('-1e308,1,1\n1e308,2,2\n', '', '{column: t}', 'the time of sample 2 is inf s, must be'),
    ('0,1,1\n1e308,2,2\n-1e308,3,3\n', '', '{column: t}',
     'position: the time does not rise after sample 2, t = 1e+308 s'),
    ('0,1,1\n1,2,2\n', ', delay_ms: 1.0e+300', '{column: t}',
     'position: the time does not rise after sample 1, t = -1e+297 s')])
def test_what_is_not_finite_in_si_is_refused(
        tmp_path: Path, rows: str, position: str, time: str, expected: str) -> None:
    with pytest.raises(BagError) as refused:
        measurement(tmp_path, rows, position, time)
    assert expected in str(refused.value)


@pytest.mark.parametrize('t, expected', [
    ([0.0, 0.25, 0.5, 600.5], '600 s after t = 0.5 s, must be <= 25 s with steps of 0.25 s'),
    ([0.0, 0.001, 0.002, 1e9], '1e+09 s after t = 0.002 s, must be <= 1 s with steps of 0.001 s'),
    ([0.0, 0.25, 0.5, 25.75, 26.0], '25.25 s after t = 0.5 s, must be <= 25 s'),
    ([0.0, 0.001, 0.002, 1.25, 1.251], '1.248 s after t = 0.002 s, must be <= 1 s')])
def test_a_long_gap_in_the_times_is_refused(
        tmp_path: Path, t: list[float], expected: str) -> None:
    with pytest.raises(BagError) as refused:
        measurement(tmp_path, rows(t))
    assert f'data.csv: position: a gap of {expected}' in str(refused.value)


@pytest.mark.parametrize('t', [
    [0.0, 0.25, 0.5, 25.5, 25.75], [0.0, 0.001, 0.002, 1.002, 1.003], [0.0, 700.0], [0.0]])
def test_a_shorter_gap_is_left(tmp_path: Path, t: list[float]) -> None:
    assert measurement(tmp_path, rows(t)).signals['position'].t.tolist() == t


@pytest.mark.parametrize('last, expected', [
    (40.25, ''), (69.5, ''),
    (71.5, 'data.csv: position_command: a gap of 26.5 s after t = 45 s, must be <= 25 s with '
           'steps of 0.25 s')])
def test_a_command_may_pause_while_outputs_go_on(last: float, expected: str) -> None:
    """The position goes on to 45 s, with steps of 0.25 s; the command has steps of 0.5 s."""
    command = Signal(np.array([0.0, 0.5, 1.0, last]), np.ones(4))
    own = Measurement('data', {'position_command': command, 'position': Signal(
        np.arange(181) / 4, np.ones(181))})
    if not expected:
        _refuse_gaps(Path('data.csv'), own)
        return
    with pytest.raises(BagError) as refused:
        _refuse_gaps(Path('data.csv'), own)
    assert str(refused.value) == expected


def test_an_output_has_no_gap_though_others_go_on() -> None:
    own = Measurement('data', {
        'position': Signal(np.arange(181) / 4, np.ones(181)),
        'force': Signal(np.array([0.0, 0.125, 0.25, 40.25]), np.ones(4))})
    with pytest.raises(BagError, match='data.csv: force: a gap of 40 s after t = 0.25 s, must be'):
        _refuse_gaps(Path('data.csv'), own)


def sloped(tmp_path: Path, rows: str) -> Measurement:
    """Return a measurement whose commanded velocity is the slope of its position, a fast clock."""
    (tmp_path / 'data.csv').write_text('t,x,s\n' + rows)
    (tmp_path / 'map.yaml').write_text(
        'time: {column: t}\nclock_ppm: -100000\nsignals:\n  position: {column: x, unit: m}\n'
        '  position_command: {column: s, unit: mm}\n'
        '  velocity_command: {from: position_command}\n')
    return read_measurement(tmp_path / 'data.csv', load_mapping(tmp_path / 'map.yaml'), False)


def test_the_slope_is_that_of_the_parabola_through_a_sample_and_its_neighbours(
        tmp_path: Path) -> None:
    """
    Of s = 1000 t^2 mm at 0, 1, 3 s it is 2 t m/s at 1 s, and at the ends of a straight line.

    The clock is slow: 0.9 s were told for a second. SI, in time and place.
    """
    own = sloped(tmp_path, '0,0,0\n0.9,0,1000\n2.7,0,9000\n').signals['velocity_command']
    assert own.t.tolist() == pytest.approx([0.0, 1.0, 3.0], abs=1e-12)
    assert own.values.tolist() == pytest.approx([1.0, 2.0, 4.0], abs=1e-12)


def test_one_sample_has_no_slope(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='position_command: has one sample, must have two for a'):
        sloped(tmp_path, '0,0,0\n')
