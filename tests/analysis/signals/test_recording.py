"""Recordings read from a bag."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from isa_ros.analysis.signals.recording import recording_of
from isa_ros.analysis.signals.signals import read_signals, Signal, Signals
from isa_ros.errors import BagError
import numpy as np
import pytest

GOLDEN = Path(__file__).parents[2] / 'golden' / 'rotor_step'


def changed(
        signals: Signals, names: Iterable[str], change: Callable[[Signal], Signal]) -> Signals:
    """Return the signals with some of them changed."""
    own = {name: signals.over_time(name) for name in signals}
    return Signals(
        signals.run, own | {name: change(own[name]) for name in names}, signals.time, 'bag')


def test_pressures_are_gauge_and_samples_on_one_grid() -> None:
    """Absolute in the messages; the supply of the rig is 20.7 MPa gauge."""
    signals = read_signals(GOLDEN)
    recording = recording_of(signals, signals.run.actuators[0], GOLDEN)
    assert recording.step == pytest.approx(1e-3, rel=1e-9)
    assert recording.supply_pressure == pytest.approx(20.7e6, rel=1e-9)
    assert recording.duration == pytest.approx(signals.time[-1])
    codes = recording.pressure_a / recording.resolution('pressure_a')
    assert codes == pytest.approx(np.round(codes), abs=1e-4)


def test_missing_samples_are_refused() -> None:
    signals = read_signals(GOLDEN)
    gap = changed(signals, signals, lambda signal: Signal(
        np.delete(signal.t, 50), np.delete(signal.values, 50)))
    with pytest.raises(BagError, match='samples are missing, a step of 2 ms'):
        recording_of(gap, signals.run.actuators[0], GOLDEN)


def test_a_topic_sampled_apart_is_refused() -> None:
    signals = read_signals(GOLDEN)
    thinned = changed(signals, ['rotor.spool'], lambda signal: Signal(
        signal.t[::2], signal.values[::2]))
    with pytest.raises(BagError, match='spool is not sampled together with the others'):
        recording_of(thinned, signals.run.actuators[0], GOLDEN)


def test_too_slow_a_bag_is_refused() -> None:
    signals = read_signals(GOLDEN)
    slow = changed(signals, signals, lambda signal: Signal(5.0 * signal.t, signal.values))
    with pytest.raises(BagError, match='sampled every 5 ms, must be at least every 2 ms'):
        recording_of(slow, signals.run.actuators[0], GOLDEN)


def test_a_missing_topic_is_named() -> None:
    signals = read_signals(GOLDEN)
    kept = {name: signals.over_time(name) for name in signals if name != 'rotor.pressure_b'}
    rest = Signals(signals.run, kept, signals.time, 'some/bag')
    with pytest.raises(BagError, match='^some/bag: rotor.pressure_b is missing'):
        recording_of(rest, signals.run.actuators[0], GOLDEN)


def test_a_standing_code_is_told_from_a_moving_one() -> None:
    """Windows in which no signal changes by more than one step."""
    signals = read_signals(GOLDEN)
    recording = recording_of(signals, signals.run.actuators[0], GOLDEN)
    step = recording.resolution('spool')
    spool = np.zeros(len(recording.spool))
    spool[20:40] = step * (np.arange(20) % 2)
    spool[40:60] = step * (np.arange(20) % 3)
    ends = np.array([0, 20, 40, 60])
    assert list(replace(recording, spool=spool).is_standing(ends, ['spool'])) == [
        True, True, False]
