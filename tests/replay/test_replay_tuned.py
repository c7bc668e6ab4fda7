"""Gains that changed during a run: recorded with their tick, and an input of the replay."""

from pathlib import Path

from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.cli.main import main
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.topic import Topic
from isa_ros.replay.replay import recorded_inputs, replay, Rerun
from isa_ros.run.local_run import LocalRun
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.tick.source import ScheduledSource
from msg_adapters.applied_parameters import applied_parameters, TYPE
import pytest

GOLDEN = Path(__file__).parents[1] / 'golden' / 'leg_touchdown'
TOPIC = '/kfe/applied_parameters'
TUNED = {'kfe': {0: {'force.kp': 9e-8}, 30: {'force.kp': 1.1e-7, 'force.kf': 1e-3}},
         'haa': {30: {'force.limit': 4e-3}}}
CHANGES = {
    0: ParameterChanges({2: TUNED['kfe'][0]}, {}),
    30: ParameterChanges({2: TUNED['kfe'][30], 0: TUNED['haa'][30]}, {})}
N_TICKS = 60


@pytest.fixture(scope='module')
def tuned(tmp_path_factory) -> Path:
    """Return a bag of the leg with gains of two actuators changed during the run."""
    provenance = Bag(GOLDEN).provenance
    local = LocalRun(run_of_text(provenance.configuration))
    directory = tmp_path_factory.mktemp('bags') / 'tuned'
    with BagWriter(directory, local.topics, provenance) as writer:
        local.simulate(N_TICKS, ScheduledSource(lambda tick, rows: None, CHANGES), writer)
    return directory


def with_kp(bag: Path, directory: Path, value: float) -> Path:
    """Record a bag again with another force.kp in its first applied parameters."""
    source = Bag(bag)
    topics = [Topic(name, source.types[name]) for name in sorted(source.types)]
    index = {topic.name: k for k, topic in enumerate(topics)}
    with BagWriter(directory, topics, source.provenance) as writer:
        for tick in source.ticks():
            writer.write_tick(tick.t_ns, tick.sequence, [
                (index[m.topic], applied_parameters('kfe', {'force.kp': value}, 0)
                 if (m.topic, tick.sequence) == (TOPIC, 1) else m.data)
                for m in tick.messages])
    return directory


def test_what_was_tuned_is_an_input_at_its_tick(tuned):
    bag = Bag(tuned)
    inputs = recorded_inputs(bag, run_of_text(bag.provenance.configuration))
    assert (inputs.tuned, inputs.n_ticks) == (TUNED, N_TICKS)
    assert bag.types[TOPIC] == TYPE


def test_a_bag_with_tuned_gains_replays_to_the_same_bytes(tuned, tmp_path):
    again = Rerun(Bag(tuned))
    with BagWriter(tmp_path / 'tuned', again.topics, Bag(tuned).provenance) as writer:
        again.simulate(writer)
    assert replay(Bag(tuned)).is_equal
    first, second = (next(d.glob('*.mcap')) for d in (tuned, tmp_path / 'tuned'))
    assert first.read_bytes() == second.read_bytes()


def test_a_gain_changed_by_one_percent_is_found(tuned, tmp_path):
    """The difference is in the first tick with a force error: it bears its load at t = 0."""
    difference = replay(Bag(with_kp(tuned, tmp_path / 'changed', 9.09e-8))).report.difference
    assert difference is not None
    assert difference.tick == 6


def test_a_recorded_gain_that_cannot_be_is_refused(tuned, tmp_path, capsys):
    """Exit code 2: an untrusted bag can only start a simulation."""
    assert main(['replay', str(with_kp(tuned, tmp_path / 'wrong', -1.0))]) == 2
    error = capsys.readouterr().err
    assert error.count('\n') == 1
    assert 'kfe: force.kp = -1 m/N, must be >= 0 m/N' in error


def test_what_was_tuned_is_no_signal_to_be_drawn(tuned):
    """Its messages change their layout."""
    signals = read_signals(tuned)
    assert len(signals.over_time('kfe.force_reference').t) == N_TICKS + 1
    assert not any('parameters' in name for name in signals)
