"""A whole run in this process: what is fed into it is recorded at its tick."""

from dataclasses import replace
import math

from isa_ros.config.runs.recording import RecordConfig
from isa_ros.core.signals import Records
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.local_run import LocalRun
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.tick.source import ScheduledSource as Scheduled
from msg_adapters import event
from msg_adapters.applied_parameters import tuned_values
from msg_adapters.setpoint import applied_to_command
import pytest
from tests.runs import hip_and_knee
from tests.sheets import setpoint

RUN = hip_and_knee()


class Recorder:
    """Keeps the messages by sequence and topic."""

    def __init__(self, run: LocalRun) -> None:
        self._topics = [topic.name for topic in run.topics]
        self.samples: dict[int, dict[str, list[bytes]]] = {}

    def write_tick(self, t_ns: int, sequence: int, messages) -> None:
        assert t_ns == sequence * RUN.step_ns
        sample = self.samples[sequence] = {}
        for topic, data in messages:
            sample.setdefault(self._topics[topic], []).append(data)


def nothing(tick: int, rows: Records) -> None:
    """Command nothing."""


def knee_at_2(tick: int, rows: Records) -> None:
    """Command the knee at tick 2."""
    if tick == 2:
        rows[1] = setpoint(position=0.06)


def recorded(inputs: Scheduled, n_ticks: int = 4, run=RUN) -> Recorder:
    local = LocalRun(run)
    recorder = Recorder(local)
    local.simulate(n_ticks, inputs, recorder)
    return recorder


def test_n_ticks_give_n_plus_1_samples():
    assert list(recorded(Scheduled(nothing)).samples) == [0, 1, 2, 3, 4]


def test_what_takes_effect_at_tick_k_is_in_sample_k_plus_1():
    """Commands once, parameters as well; the first sample has what the run starts with."""
    tuned = {1: ParameterChanges({0: {'force.kp': 9e-5}}, {})}
    samples = recorded(Scheduled(knee_at_2, tuned)).samples
    topic = '/knee/applied_setpoint'
    assert [k for k, sample in samples.items() if topic in sample] == [0, 3]
    assert applied_to_command(samples[3][topic][0], 'knee')['position'] == 0.06
    topic = '/hip/applied_parameters'
    assert [k for k, sample in samples.items() if topic in sample] == [2]
    assert tuned_values(samples[2][topic][0], 'hip') == {'force.kp': 9e-5}


def test_events_are_recorded_before_their_tick():
    samples = recorded(Scheduled(nothing, events={0: ['pause', 'step 1'], 4: ['reset']})).samples
    assert {k: [event.text(data) for data in sample['/coordinator/events']]
            for k, sample in samples.items() if '/coordinator/events' in sample} == {
                0: ['pause', 'step 1'], 4: ['reset']}


@pytest.mark.parametrize('at', [1, 2, 3, 17])
def test_an_event_behind_quiet_ticks_is_recorded_before_its_tick(at):
    """A pause that was recorded has the instant at which the run stood."""
    source = Scheduled(nothing, events={at: ['pause']}, next_command=lambda tick: math.inf)
    samples = recorded(source, 20).samples
    assert [k for k, sample in samples.items() if '/coordinator/events' in sample] == [at]


def test_it_records_what_the_run_wants_recorded():
    """The kept topics alone, the decimated ones at every n-th tick."""
    record = RecordConfig(leave_out=('/*/valve',), decimate=(('/hip/load_cell', 2),))
    run = replace(RUN, record=record)
    thinned, whole = recorded(Scheduled(knee_at_2), run=run), recorded(Scheduled(knee_at_2))
    assert thinned.samples == {
        k: {topic: data for topic, data in sample.items() if not topic.endswith('/valve')
            and not (topic == '/hip/load_cell' and k % 2)}
        for k, sample in whole.samples.items()}


def test_it_stops_when_asked():
    """After whole ticks."""
    local = LocalRun(RUN)
    recorder = Recorder(local)
    with pytest.raises(Interrupted, match='stopped after 2 ticks'):
        local.simulate(9, Scheduled(nothing), recorder, lambda: len(recorder.samples) == 3)
    assert list(recorder.samples) == [0, 1, 2]
