"""Setpoints of quiet ticks: what publishers of this process get of them, and when."""

from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.core.topic import KEPT
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.packing import Messages
from isa_ros.run.quiet_setpoints import QuietSetpoints
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
from isa_ros.tick.planned import MOST
from msg_adapters.actuator_messages import APPLIED_PLACE
from msg_adapters.cdr_reader import decode
import pytest
from sensor_msgs.msg import JointState
from tests.tick.quietly import advance

N_TICKS = 150


class Publishers:
    """Those of an actuator; somebody subscribes before a number of looks for subscriptions."""

    wanted = (APPLIED_PLACE,)

    def __init__(self, heard_from: float = float('inf')) -> None:
        self.left, self.sent = heard_from, []
        self.is_heard = False

    def refresh(self) -> None:
        self.left -= 1
        self.is_heard = self.left <= 0

    def skip(self, n_ticks: int) -> None:
        pass

    def has_subscribers(self) -> bool:
        return self.is_heard

    def publish(self, messages: Messages) -> None:
        if messages[APPLIED_PLACE] is not None:
            self.sent.append(messages[APPLIED_PLACE])


def leg(outlets: list[Publishers]) -> Simulation:
    """Return one that trots, with publishers of its actuators and no recorder."""
    simulation = load('leg', scenario='trot_leg').simulation()
    run = simulation.scenario.run
    simulation.loop.sinks = (RunOutput(
        packer_of(run, simulation.loop.rows.published), run.step_ns, None,
        Outlets(actuators=outlets)),)
    return simulation


def published(pattern: tuple[int, ...], outlets: list[Publishers]) -> int:
    """Run it by calls of so many ticks; return its single ticks."""
    return advance(leg(outlets), N_TICKS, pattern)


@pytest.fixture(scope='module')
def each() -> list[list[bytes]]:
    """Return what is published of each actuator tick by tick."""
    outlets = [Publishers() for _ in range(3)]
    assert published((1,), outlets) == N_TICKS
    found = [own.sent for own in outlets]
    assert len({message for own in found for message in own}) == sum(map(len, found)) > 300
    return found


def test_without_a_subscription_the_last_of_a_call_are_published(each):
    """And that of each tick between calls, in their order; kernels took the others."""
    outlets = [Publishers() for _ in range(3)]
    assert published((MOST,), outlets) < 10
    for own, all_of_it in zip(outlets, each):
        places = [all_of_it.index(message) for message in own.sent]
        assert places == sorted(places) and len(set(places)) == len(places)
        assert own.sent[-1] == all_of_it[-1]
        gaps = [b - a - 1 for a, b in zip(places, places[1:]) if b > a + 1]
        assert gaps and max(gaps) <= MOST - KEPT.depth
        end = places[next(k for k, (a, b) in enumerate(zip(places, places[1:])) if b > a + 1)]
        first = places.index(end + gaps[0] + 1)
        following = places[first:first + KEPT.depth]
        assert following == list(range(following[0], following[0] + KEPT.depth))


def test_one_that_comes_during_a_call_receives_all_of_it(each):
    """Of its own actuator; what was published before are the last ones of the calls before."""
    outlets = [Publishers(), Publishers(2), Publishers()]   # a look after each call
    published((40,), outlets)
    heard = outlets[1].sent
    of_first = [each[1].index(message) for message in heard]
    gaps = [b for a, b in zip(of_first, of_first[1:]) if b > a + 1]
    assert len(gaps) == 1       # in front of the last ones of the first call
    assert of_first[-1] == len(each[1]) - 1
    assert len(outlets[0].sent) < len(heard)


def test_what_is_in_force_afterwards_is_the_last(each):
    """A tick of Python, and its message, follow what a call has left."""
    simulation = leg([Publishers() for _ in range(3)])
    simulation.loop.begin()
    for _ in range(3):
        simulation.loop.advance()
    simulation.loop.advance_quietly(40)
    other = load('leg', scenario='trot_leg').simulation()
    other.loop.begin()
    for _ in range(40):
        other.loop.advance()
    assert simulation.ticks == other.ticks == 40
    assert simulation.loop.rows.applied.tobytes() == other.loop.rows.applied.tobytes()


def test_what_took_effect_in_a_tick_that_python_ends_stays():
    """Behind those that were kept; their messages are of their own ticks."""
    simulation = leg([])
    rows, run = simulation.loop.rows, simulation.scenario.run
    outlets = [Publishers(0) for _ in range(3)]
    own = QuietSetpoints(packer_of(run, rows.published), outlets)
    _, part = own.begin()
    rows.applied['kinds'] = (0, HAS_SETPOINT, 0)
    for position in (0.02, 0.03):
        rows.applied['position'][1] = position
        part.bound.run()
    rows.applied['position'][1] = 0.04
    own.publish(7, run.step_ns)
    assert rows.applied['position'][1] == 0.04
    found = [decode(data, JointState) for data in outlets[1].sent]
    assert [message.position[0] for message in found] == [0.02, 0.03]
    assert [message.header.stamp.nanosec for message in found] == [7_000_000, 8_000_000]
    assert outlets[0].sent == outlets[2].sent == []
