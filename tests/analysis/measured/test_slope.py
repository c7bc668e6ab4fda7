"""The slope of commands that are held between their changes, and of those that are not."""

from pathlib import Path

from isa_ros.analysis.measured.mapping import load_mapping
from isa_ros.analysis.measured.measurement import read_measurement
from isa_ros.analysis.measured.slope import Slope, slope_of
from isa_ros.analysis.signals.signals import Signal
import numpy as np
import pytest

T = np.arange(2000) * 1e-3


def motion(t: np.ndarray) -> np.ndarray:
    """Return a command in m: it rests, moves 40 mm as a raised cosine, and rests again."""
    return 0.02 * (1.0 - np.cos(np.pi * np.clip(t - 0.4, 0.0, 1.0)))


def velocity(t: np.ndarray) -> np.ndarray:
    """Return its slope, m/s."""
    return 0.02 * np.pi * np.sin(np.pi * np.clip(t - 0.4, 0.0, 1.0))


def held(n: int, begin: int = 0) -> Signal:
    """Return the motion as it was at every nth sample, the first of them ``begin``."""
    return Signal(T, motion(T[np.maximum((np.arange(len(T)) - begin) // n * n + begin, 0)]))


def at(slope: Slope) -> np.ndarray:
    """Return the slope at each sample, held until the next one as a command is."""
    return slope.signal.values[np.searchsorted(slope.signal.t, T, side='right') - 1]


@pytest.mark.parametrize(('n', 'begin'), [(20, 0), (20, 7), (20, 19), (2, 1), (100, 30)])
def test_the_slope_of_a_held_command_is_that_of_its_changes(n: int, begin: int) -> None:
    """
    Held as long: within half the change of slope over a hold at its own samples.

    The slope from one neighbour to the other is that of a parabola, but where a rest ends: there
    the slope bends, by 0.02 m pi^2 / s^2 over a hold h, and a quarter of that is missed.
    """
    found = slope_of(held(n, begin))
    assert (found.n_held, found.hold) == (n, pytest.approx(n * 1e-3))
    bend = 0.02 * np.pi ** 2 * n * 1e-3
    made = np.maximum((np.arange(len(T)) - begin) // n * n + begin, 0)
    assert np.abs(at(found) - velocity(T[made])).max() < 0.3 * bend
    assert found.signal.t[0] == 0.0 and (np.diff(found.signal.t) > 0.0).all()


def test_a_rest_has_no_slope() -> None:
    """Neither long before the motion nor long after it; also where its length is no whole hold."""
    found = at(slope_of(held(20, 7)))
    assert np.abs(found[(T < 0.37) | (T > 1.44)]).max() < 1e-9     # numpy rounds
    assert found.max() == pytest.approx(0.02 * np.pi, rel=0.01)


@pytest.mark.parametrize('begin', [1, 10, 19])
def test_a_command_that_moves_from_the_first_sample_has_its_slope_there(begin: int) -> None:
    """What was commanded before the log had begun as long before."""
    own = Signal(T, 0.1 * np.maximum((np.arange(len(T)) - begin) // 20 * 20 + begin, begin - 20)
                 * 1e-3)
    assert at(slope_of(own)) == pytest.approx(np.full(len(T), 0.1), rel=1e-9)


def test_a_jitter_of_the_hold_is_no_pause() -> None:
    """Commands at 19, 41, 60, ... as a computer without real time makes them."""
    made = np.cumsum(np.tile([19, 22, 19, 20], 24))
    own = Signal(T, 0.1 * T[np.concatenate([[0], made])][
        np.searchsorted(made, np.arange(len(T)), side='right')])
    found = slope_of(own)
    assert found.n_held == 20     # the median of 19, 19, 20, 22 is 19.5, rounded to even
    # made at 0 as if a whole hold earlier; at the end it is held to the end
    assert at(found)[20:1900] == pytest.approx(np.full(1880, 0.1), rel=0.1)


def test_a_command_that_is_not_held_has_its_slope_at_every_sample() -> None:
    """Also one that rests and then ramps; bytes as by numpy."""
    for own in (Signal(T, motion(T)), Signal(T, np.clip(T - 1.8, 0.0, 1.0)),
                Signal(T, np.zeros(len(T))), Signal(T, np.repeat([0.0, 1.0, 0.0, 2.0], 500))):
        found = slope_of(own)
        assert found.n_held == 1 and not found.remark('a', 'b')
        assert found.signal.values.tobytes() == np.gradient(own.values, own.t).tobytes()
        assert found.signal.t is own.t


@pytest.mark.parametrize(('n', 'n_changes', 'expected'), [
    (20, 10, 20), (20, 9, 1), (105, 12, 105), (115, 12, 1)])
def test_steps_are_not_held(n: int, n_changes: int, expected: int) -> None:
    """Too few, or more than 0.11 s apart."""
    values = np.minimum(np.arange(len(T)) // n, n_changes).astype(float)
    assert slope_of(Signal(T, values)).n_held == expected


@pytest.mark.parametrize('n', [1, 20])
def test_a_held_command_is_told(tmp_path: Path, n: int) -> None:
    own = held(n)
    np.savetxt(tmp_path / 'data.csv', np.stack([own.t, 1e3 * own.values], axis=1), '%.9f', ',',
               header='t,s', comments='')
    (tmp_path / 'map.yaml').write_text(
        'time: {column: t}\nsignals:\n  position_command: {column: s, unit: mm}\n'
        '  velocity_command: {from: position_command}\n')
    found = read_measurement(tmp_path / 'data.csv', load_mapping(tmp_path / 'map.yaml'), False)
    assert found.remark == ('' if n == 1 else (
        'position_command is held for 20 samples, 20 ms: velocity_command is its slope from '
        'change to change, held as long; map the commanded velocity itself if it was logged'))
    assert found.signals['velocity_command'].values.max() == pytest.approx(0.02 * np.pi, rel=0.01)


@pytest.mark.parametrize(('step', 'rate', 'fast'), [
    (1e-5, 1e3, 0.05), (5e-5, 2e3, 0.1), (2e-5, 1e3, 0.03)])
def test_a_command_that_is_rounded_is_not_held(step: float, rate: float, fast: float) -> None:
    """It changes the sooner the faster it moves: a rapid stroke keeps its speed."""
    t = np.arange(round(4.0 * rate)) / rate
    place = fast * np.clip(t - 0.5, 0.0, 0.4) + 0.1 * fast * np.clip(t - 0.9, 0.0, None)
    found = slope_of(Signal(t, step * np.round(place / step)))
    assert found.n_held == 1
    within = (found.signal.t > 0.55) & (found.signal.t < 0.85)
    assert found.signal.values[within].mean() == pytest.approx(fast, rel=0.02)


def test_a_held_command_keeps_a_change_that_comes_early() -> None:
    """One of many, as of a program that was late once: its value is among those of the slope."""
    values = held(20).values.copy()
    values[909:920] = values[920]     # at 0.909 s instead of 0.92
    found = slope_of(Signal(T, values))
    assert found.n_held == 20
    assert {0.9, 0.909} <= {round(float(t), 3) for t in found.signal.t}
    values[901:920] = values[920]
    assert {0.9, 0.901} <= {round(float(t), 3) for t in slope_of(Signal(T, values)).signal.t}
