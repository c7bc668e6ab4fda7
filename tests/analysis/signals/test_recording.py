"""Recordings read from a bag."""

from dataclasses import replace
from pathlib import Path

from isa_ros.analysis.signals.recording import recording_of
from isa_ros.analysis.signals.traces import read_traces
from isa_ros.errors import BagError
import numpy as np
import pytest

GOLDEN = Path(__file__).parents[2] / 'golden' / 'rotor_step'


def test_pressures_are_gauge_and_samples_on_one_grid() -> None:
    """Absolute in the messages; the supply of the rig is 20.7 MPa gauge."""
    run, traces = read_traces(GOLDEN)
    recording = recording_of(run, traces, run.actuators[0], GOLDEN)
    assert recording.step == pytest.approx(1e-3, rel=1e-9)
    assert recording.supply_pressure == pytest.approx(20.7e6, rel=1e-9)
    assert recording.duration == pytest.approx(traces['/clock'].t[-1])
    codes = recording.pressure_a / recording.resolution('pressure_a')
    assert codes == pytest.approx(np.round(codes), abs=1e-4)


def test_missing_samples_are_refused() -> None:
    run, traces = read_traces(GOLDEN)
    gap = {name: replace(trace, t=np.delete(trace.t, 50), fields=np.delete(trace.fields, 50))
           for name, trace in traces.items() if len(trace.t) > 50}
    with pytest.raises(BagError, match='samples are missing, a step of 2 ms'):
        recording_of(run, gap, run.actuators[0], GOLDEN)


def test_a_topic_sampled_apart_is_refused() -> None:
    run, traces = read_traces(GOLDEN)
    valve = traces['/rotor/valve']
    thinned = traces | {'/rotor/valve': replace(valve, t=valve.t[::2], fields=valve.fields[::2])}
    with pytest.raises(BagError, match='/rotor/valve is not sampled together with the others'):
        recording_of(run, thinned, run.actuators[0], GOLDEN)


def test_too_slow_a_bag_is_refused() -> None:
    run, traces = read_traces(GOLDEN)
    slow = {name: replace(trace, t=5.0 * trace.t) for name, trace in traces.items()}
    with pytest.raises(BagError, match='sampled every 5 ms, must be at least every 2 ms'):
        recording_of(run, slow, run.actuators[0], GOLDEN)


def test_a_missing_topic_is_named() -> None:
    run, traces = read_traces(GOLDEN)
    del traces['/rotor/pressure_b']
    with pytest.raises(BagError, match='/rotor/pressure_b is missing'):
        recording_of(run, traces, run.actuators[0], GOLDEN)


def test_a_standing_code_is_told_from_a_moving_one() -> None:
    """Windows in which no signal changes by more than one step."""
    run, traces = read_traces(GOLDEN)
    recording = recording_of(run, traces, run.actuators[0], GOLDEN)
    step = recording.resolution('spool')
    spool = np.zeros(len(recording.spool))
    spool[20:40] = step * (np.arange(20) % 2)
    spool[40:60] = step * (np.arange(20) % 3)
    ends = np.array([0, 20, 40, 60])
    assert list(replace(recording, spool=spool).is_standing(ends, ['spool'])) == [
        True, True, False]
