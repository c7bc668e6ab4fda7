"""A lossy link from a bag and in memory: statistics, replay, save and restore, one sha256."""

from collections.abc import Mapping
from dataclasses import dataclass
import hashlib

import isa_ros
from isa_ros.bag.reader import Bag, BagMessage
from isa_ros.config.runs.recording import replay_needs
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.replay.replay import replay
from msg_adapters.cdr_reader import decode
from msg_adapters.setpoint import sent_to_command
import numpy as np
import pytest
from scipy import stats
from sensor_msgs.msg import JointState

ALARM = 1e-6
"""Probability with which a check would refuse numbers that are truly random."""
TICK_NS = 1_000_000
TICKS = 1500
LOSS, JITTER_US, DELAY_MS = 0.2, 200.0, 2.0
LINK = {'kind': 'can', 'cycle_ms': 1.0, 'delay_cycles': 2, 'jitter_us': JITTER_US, 'loss': LOSS,
        'watchdog_ms': 5.0}
RUN = {
    'name': 'ram', 'step_ms': 1.0, 'controller_offset_ms': 0.12, 'tick_timeout_s': 5.0,
    'seed': 11,
    'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
    'actuators': {'ram': {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'link': LINK},
                  'twin': {'model': 'isa_v5', 'load': {'kind': 'mass'}}}}


class Ramp(Controller):
    """Commands another position at every tick, and stores the ages that it sees."""

    def __init__(self) -> None:
        self.ages: list[float] = []

    def step(self, state: State) -> Mapping[str, Setpoint]:
        self.ages.append(float(state.actuators['ram'].age))
        return {name: Setpoint(position=0.05 + 1e-9 * state.t_ns / TICK_NS) for name in
                ('ram', 'twin')}

    def snapshot(self) -> bytes:
        return b'none'

    def restore(self, snapshot: bytes) -> None:
        """Continue: the command depends on the time only."""


@dataclass
class Recorded:
    """One run in memory and in its bag."""

    result: isa_ros.Result
    bag: Bag
    ages: list[float]

    def messages(self, suffix: str) -> list[BagMessage]:
        return [each for each in self.bag.messages() if each.topic == f'/ram/{suffix}']

    def stamps(self, suffix: str) -> np.ndarray:
        """Return the stamps of a topic of the ram, ns."""
        stamps = [decode(each.data, JointState).header.stamp for each in self.messages(suffix)]
        return np.array([each.sec * 1_000_000_000 + each.nanosec for each in stamps])


@pytest.fixture(scope='module')
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    ramp = Ramp()
    result = isa_ros.load(RUN).simulate(duration=TICKS * 1e-3, controllers=[ramp])
    return Recorded(result, Bag(result.save(tmp_path_factory.mktemp('link') / 'ram')), ramp.ages)


def within(n_lost: int, n: int) -> bool:
    """Return whether a binomial number is not less likely than `ALARM`."""
    return stats.binomtest(n_lost, n, LOSS).pvalue > ALARM


def test_every_setpoint_is_sent_and_as_many_applied_as_configured(recorded):
    """One that is lost is overtaken by the next: it never takes effect."""
    sent, applied = recorded.messages('sent_setpoint'), recorded.messages('applied_setpoint')[1:]
    assert len(sent) == TICKS - 1
    on_their_way = 3
    assert within(len(sent) - len(applied) - on_their_way, len(sent))


def test_each_applied_setpoint_came_after_the_delay_and_the_jitter(recorded):
    """By position, which tells the setpoints apart; uniform over 200 us, in plant steps of 20."""
    def by_position(suffix: str) -> dict[float, int]:
        return {decode(each.data, JointState).position[0]: stamp for each, stamp in zip(
            recorded.messages(suffix), recorded.stamps(suffix))}
    sent, applied = by_position('sent_setpoint'), by_position('applied_setpoint')
    late = np.array([applied[position] - sent[position] for position in applied.keys() & sent])
    steps = (late - DELAY_MS * 1e6) / PLANT_STEP_NS
    assert len(late) > 1000 and set(steps) == set(range(1, 11))
    assert stats.chisquare(np.bincount(steps.astype(int))[1:]).pvalue > ALARM


def test_the_state_has_the_time_of_sampling_and_is_held_where_a_frame_is_lost(recorded):
    """Sampled at ticks, on its way for 2 ms and a jitter: seen 3 ms later, if it is not lost."""
    stamps = recorded.stamps('joint_states')
    ages = np.arange(TICKS + 1) * TICK_NS - stamps
    assert set(ages[3:] % TICK_NS) == {0} and ages[3:].min() == 3 * TICK_NS
    assert (np.diff(stamps) >= 0).all()
    n_sent = TICKS - 3
    n_lost = n_sent - len(np.unique(stamps[4:]))
    assert within(n_lost, n_sent)


def test_messages_have_the_values_of_their_stamp(recorded):
    positions = [decode(each.data, JointState).position[0]
                 for each in recorded.messages('joint_states')]
    sampled = recorded.stamps('joint_states') // TICK_NS
    exact = recorded.result['ram.position']
    assert positions == exact[sampled].tolist()
    assert positions == recorded.result['ram.link.position'].tolist()
    assert positions != exact.tolist()


def test_controllers_have_what_has_arrived(recorded):
    """As recorded, with its age; without a link it is 0."""
    ages = recorded.result['ram.link.age']
    assert recorded.ages == ages[:-1].tolist()
    stamps = recorded.stamps('joint_states')
    assert np.round(ages * 1e9).astype(int).tolist() == (
        np.arange(TICKS + 1) * TICK_NS - stamps).tolist()
    assert not recorded.result['ram.age'].any() and not recorded.result['twin.age'].any()
    assert recorded.result.units['ram.link.age'] == 's'
    assert 'twin.link.age' not in recorded.result


def test_an_actuator_beside_it_has_no_link(recorded):
    topics = {topic for topic in recorded.bag.types if topic.startswith('/twin')}
    assert '/twin/sent_setpoint' not in topics and '/twin/joint_states' in topics
    assert len([each for each in recorded.bag.messages()
                if each.topic == '/twin/applied_setpoint']) == TICKS


def test_the_replay_simulates_the_link_again(recorded):
    report = replay(recorded.bag)
    assert report.is_equal, report


def test_a_bag_of_another_seed_differs_and_one_of_the_same_does_not(recorded, tmp_path):
    short = isa_ros.load(RUN)
    digests = []
    for k, seed in enumerate((11, 11, 12)):
        result = short.replace({'seed': seed}).simulate(duration=0.1, controllers=[Ramp()])
        bag = result.save(tmp_path / str(k) / 'ram')
        digests.append(hashlib.sha256((bag / 'ram_0.mcap').read_bytes()).hexdigest())
        assert result['ram.link.age'].tobytes() == (
            recorded.result['ram.link.age'][:101].tobytes()) or seed == 12
    assert digests[0] == digests[1] != digests[2]


def test_a_run_restored_in_the_middle_goes_on_alike(recorded):
    simulation = isa_ros.load(RUN).simulation(controllers=[Ramp()])
    for _ in range(40):
        simulation.step()
    saved = simulation.snapshot()
    other = isa_ros.load(RUN).simulation(controllers=[Ramp()])
    other.restore(saved)
    for tick in range(41, 120):
        other.step()
        for name in ('position', 'age'):
            assert other.observed['ram'][name] == recorded.result[f'ram.link.{name}'][tick]
        assert other.samples['ram'].position == recorded.result['ram.position'][tick]


def test_sent_setpoints_read_back_as_they_were_sent(recorded):
    log = recorded.result.log
    for each in recorded.messages('sent_setpoint')[:20]:
        command = sent_to_command(each.data, 'ram')
        sent = log.sent[each.sequence][0]
        assert command['position'] == sent['position']
        assert np.isnan(command['stiffness']) and np.isnan(command['damping'])
        assert command['kinds'] == sent['kinds']


def test_a_bag_always_has_what_was_sent():
    assert replay_needs('/ram/sent_setpoint') and not replay_needs('/ram/joint_states')
