"""What a run tells, to whom, and what is not even packed."""

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.run.live import every_tick, PeriodOf
from isa_ros.run.outlets import NoOutlet, Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.packing import Messages, Packer
from isa_ros.tick.exchange import Rows
from isa_ros.tick.planned import MOST
from msg_adapters import clock, event
import numpy as np
import pytest
from tests.run.recorder import FakeRecorder
from tests.runs import hip_and_knee

RUN = hip_and_knee()
STEP_NS = RUN.step_ns


class FakeOutlet:
    """Keeps what is published where it has a subscription."""

    wanted = None

    def __init__(self, log: list[str], name: str, has_subscription: bool) -> None:
        self.log, self.name, self.has_subscription = log, name, has_subscription
        self.is_seen = has_subscription
        self.to_look = 20
        self.sent: list[Messages] = []

    def refresh(self) -> None:
        self.is_seen, self.to_look = self.has_subscription, 20

    def skip(self, n_ticks: int) -> None:
        self.to_look -= n_ticks

    def has_subscribers(self) -> bool:
        if self.to_look <= 0:
            self.refresh()
        return self.is_seen

    def publish(self, messages: Messages) -> None:
        self.log.append(self.name)
        self.sent.append(list(messages))


class Stage:
    """A run's output, with outlets of which some have a subscription."""

    def __init__(
            self, *heard: str, is_recorded: bool = True,
            period_of: PeriodOf = every_tick) -> None:
        self.log: list[str] = []
        self.group: ActuatorGroup = group_of(RUN)
        self.rows = Rows(2, surroundings_of(RUN))
        self.rows.samples[:] = self.group.samples
        self.rows.samples['state_since'] = -1.0  # the device has nothing new
        self.outlets = {name: FakeOutlet(self.log, name, name in heard) for name in (
            'clock', 'events', 'surroundings', 'hip', 'knee')}
        self.recorder = FakeRecorder(self.log)
        packer = packer_of(RUN, self.rows.published)
        self.topics = [topic.name for topic in packer.topics]
        self.output = RunOutput(
            packer, RUN.step_ns, self.recorder if is_recorded else None, Outlets(
                clock=self.outlets['clock'], events=self.outlets['events'],
                surroundings=self.outlets['surroundings'],
                actuators=[self.outlets['hip'], self.outlets['knee']]), period_of=period_of)

    def take(self, tick: int, tuned=None) -> None:
        """Give the output the rows before a tick."""
        self.rows.tuned = tuned or {}
        self.output.take(tick, self.rows)

    def expected(self, tick: int, tuned=None) -> Packer:
        """Return a packer of the run that has packed this instant."""
        packer = packer_of(RUN, self.rows.published)
        packer.pack(tick * STEP_NS, max(0, (tick - 1) * STEP_NS), tuned or {})
        return packer


@pytest.mark.parametrize('name', ['clock', 'surroundings', 'hip', 'knee'])
def test_a_subscription_is_seen_before_the_next_call_of_quiet_ticks(name):
    """And so is its end; those of events are looked at when there is one."""
    stage = Stage()
    outlet = stage.outlets[name]
    assert stage.output.quiet_ticks(0) > 100
    outlet.has_subscription = True
    stage.output.end_quiet(0, 200)
    assert stage.output.quiet_ticks(200) == 0
    outlet.has_subscription, stage.outlets['events'].has_subscription = False, True
    stage.output.end_quiet(200, 20)
    assert stage.output.quiet_ticks(200) > 100


@pytest.mark.parametrize('is_recorded', [True, False])
@pytest.mark.parametrize('expected', [(True, False), (False, False)])
def test_a_call_in_which_setpoints_are_applied_has_room_for_them(is_recorded, expected):
    """They are kept beside the recording; a call without any is as long as it may be."""
    stage = Stage(is_recorded=is_recorded)
    assert stage.output.takes_applied(np.array(expected))
    most, parts = stage.output.begin_quiet(0, 1000, np.array([0, STEP_NS]))
    assert len(parts) == is_recorded + any(expected)
    assert most == MOST if any(expected) else MOST < most <= 1000


EVERYONE = ('clock', 'events', 'surroundings', 'hip', 'knee')


@pytest.mark.parametrize('heard', [(), ('clock',), ('clock', 'events')])
def test_nothing_is_packed_where_nothing_is_recorded_and_nobody_subscribes(heard, monkeypatch):
    """Time and events are messages of their own, and not part of the rows."""
    stage = Stage(*heard, is_recorded=False)

    def pack(*arguments):
        pytest.fail('rows were packed')
    monkeypatch.setattr(Packer, 'pack', pack)
    stage.output.take_time(1)
    stage.output.add_event(1, 'step 1')
    stage.take(1)
    stage.output.record()
    assert stage.log == list(heard)


def test_what_was_applied_is_passed_on_without_a_subscription():
    """Its publishers keep it for later subscriptions; one actuator's is not the other's."""
    stage = Stage(is_recorded=False)
    stage.rows.applied['kinds'][0] = HAS_SETPOINT
    stage.take(1)
    assert stage.log == ['hip']
    stage.rows.applied['kinds'] = 0
    stage.take(2, {1: {'force.kp': 1e-7}})
    assert stage.log == ['hip', 'knee']


def test_a_change_of_the_device_is_passed_on_without_a_subscription():
    """Of one actuator alone, and at that tick alone; a second of simulated time is one too."""
    stage = Stage(is_recorded=False)
    stage.rows.samples['state_since'][1] = 1.5 * STEP_NS * 1e-9
    for tick in (3, 4):
        stage.take(tick)
    assert stage.log == []
    stage.take(2)
    assert stage.log == ['knee']
    stage.take(10**9 // STEP_NS)
    assert stage.log == ['knee', 'hip', 'knee']


@pytest.mark.parametrize('listener', ['surroundings', 'hip', 'knee', None])
def test_one_listener_or_the_recorder_is_enough_to_pack(listener, monkeypatch):
    """And packs once."""
    stage = Stage(*filter(None, [listener]), is_recorded=listener is None)
    packed, pack = [], Packer.pack

    def note(self, *arguments):
        packed.append(arguments)
        pack(self, *arguments)
    monkeypatch.setattr(Packer, 'pack', note)
    stage.take(3)
    assert packed == [(3 * STEP_NS, 2 * STEP_NS, {}, {})]


def test_outlets_get_the_messages_of_their_own_sources():
    """Each in the order of its topics, with what was applied and tuned at the tick's start."""
    stage = Stage(*EVERYONE)
    stage.rows.applied[1]['kinds'] = HAS_SETPOINT
    tuned = {0: {'force.kp': 1e-7}}
    stage.take(3, tuned)
    expected = stage.expected(3, tuned)
    assert stage.outlets['hip'].sent == [expected.of_actuator(0)]
    assert stage.outlets['knee'].sent == [expected.of_actuator(1)]
    assert stage.outlets['surroundings'].sent == [expected.of(expected.surroundings)]
    assert stage.outlets['clock'].sent == stage.outlets['events'].sent == []


@pytest.mark.parametrize('heard', EVERYONE)
def test_nothing_is_sent_where_nobody_subscribes(heard):
    """The recorder gets all of it nevertheless."""
    stage = Stage(heard)
    stage.output.take_time(1)
    stage.output.add_event(1, 'step 1')
    stage.take(1)
    stage.output.record()
    assert stage.log == [heard, 'record 1']
    assert [sequence for _, sequence, _ in stage.recorder.samples] == [1]


def test_the_time_is_published_before_the_rest_of_its_instant():
    """As a coordinator calls it: time, then the rows, then the record."""
    stage = Stage(*EVERYONE)
    stage.output.take_time(2)
    stage.take(2)
    stage.output.record()
    assert stage.log == ['clock', 'hip', 'knee', 'surroundings', 'record 2']
    assert stage.outlets['clock'].sent == [[clock.pack(2 * STEP_NS)]]


def test_an_instant_is_recorded_once_with_all_its_events():
    """What is noted after the rows were packed is of the same instant; the next one has none."""
    stage = Stage()
    stage.output.add_event(1, 'pause')
    stage.take(1)
    stage.output.add_event(1, 'step 1')
    for _ in range(2):
        stage.output.record()
    stage.take(2)
    stage.output.record()
    (t_ns, sequence, first), (_, _, second) = stage.recorder.samples
    assert (t_ns, sequence) == (STEP_NS, 1)
    place = stage.topics.index('/coordinator/events')
    assert [event.text(data) for topic, data in first if topic == place] == ['pause', 'step 1']
    assert [topic for topic, _ in second if topic == place] == []


def test_the_recorder_gets_the_packed_instant():
    """The rows of then, also where they have changed since."""
    stage = Stage()
    stage.take(3, {1: {'force.kp': 1e-7}})
    expected = list(stage.expected(3, {1: {'force.kp': 1e-7}}).all_messages())
    stage.rows.samples['position'] += 1.0
    stage.output.record()
    assert stage.recorder.samples == [(3 * STEP_NS, 3, expected)]


def test_where_actuators_publish_for_themselves_the_rest_is_published():
    """Their outlets are left out: they have processes of their own."""
    stage = Stage(*EVERYONE)
    output = RunOutput(packer_of(RUN, stage.rows.published), RUN.step_ns, stage.recorder, Outlets(
        surroundings=stage.outlets['surroundings']))
    output.take(1, stage.rows)
    output.record()
    assert stage.log == ['surroundings', 'record 1']


def test_an_outlet_without_topics_has_no_subscribers():
    assert not NoOutlet().has_subscribers()
    assert [Outlets().clock.has_subscribers(), Outlets().events.has_subscribers(),
            Outlets().surroundings.has_subscribers(), *Outlets().actuators] == [False] * 3


def test_the_end_adds_the_diagnostics_of_the_last_instant():
    """To the bag and to who listens; where it is recorded already, to nothing."""
    stage = Stage('surroundings')
    stage.take(3)
    stage.output.end()
    stage.output.end()
    expected = stage.expected(3)
    place, data = stage.topics.index('/diagnostics'), expected.rare.diagnose()
    (_, sequence, messages), = stage.recorder.samples
    assert sequence == 3 and (place, data) in messages
    assert stage.log == ['surroundings', 'surroundings', 'record 3']
    before, at_end = stage.outlets['surroundings'].sent
    shown = [topic.name for topic in expected.surroundings].index('/diagnostics')
    assert before[shown] is None and at_end[shown] == data
    assert at_end.count(None) == len(at_end) - 1


PERIODS = {'/clock': 3, '/coordinator/supply_pressure': 2, '/knee/valve': 4}


def test_topics_with_a_period_are_published_at_their_ticks_alone_and_recorded_at_each():
    stage = Stage(*EVERYONE, period_of=lambda topic: PERIODS.get(topic.name, 1))
    names = {'hip': [name for name in stage.topics if name.startswith('/hip/')],
             'knee': [topic.name for topic in stage.expected(0).topics_of(1)]}
    for tick in range(1, 13):
        stage.output.take_time(tick)
        stage.take(tick)
        stage.output.record()
    assert len(stage.outlets['clock'].sent) == 4
    valve = names['knee'].index('/knee/valve')
    assert [tick for tick, sent in enumerate(stage.outlets['knee'].sent, 1)
            if sent[valve] is not None] == [4, 8, 12]
    other = names['knee'].index('/knee/references')
    assert all(sent[other] is not None for sent in stage.outlets['knee'].sent)
    assert len(stage.outlets['hip'].sent) == 12
    surroundings = [topic.name for topic in stage.expected(0).surroundings]
    supply = surroundings.index('/coordinator/supply_pressure')
    assert [tick for tick, sent in enumerate(stage.outlets['surroundings'].sent, 1)
            if sent[supply] is not None] == [2, 4, 6, 8, 10, 12]
    for name in ('/knee/valve', '/clock', '/coordinator/supply_pressure'):
        index = stage.topics.index(name)
        assert [index in [k for k, _ in messages] for _, _, messages in stage.recorder.samples
                ] == [True] * 12
