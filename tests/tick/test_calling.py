"""Controllers between a transport and its rows: order, time, and who a failure is."""

from types import SimpleNamespace
from typing import Any

from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.signals import COMMAND, HAS_SETPOINT, SAMPLE
from isa_ros.errors import ConfigError, RunError
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.calling import calling, CallingTransport
import numpy as np
import pytest

NAMES, STEP_NS = ['haa', 'kfe'], 1_000_000


class Others:
    """The transport below: it notes what it is asked, and nodes request what is given."""

    def __init__(self) -> None:
        self.group, self.asked = object(), []
        self.of_nodes = np.zeros(2, COMMAND)

    def begin(self) -> None:
        self.asked.append('begin')

    def join(self, rows: Any) -> None:
        self.asked.append('join')

    def restore(self, tick: int, snapshots: Any, rows: Any) -> None:
        self.asked.append(('restore', tick, list(snapshots)))

    def send(self, tick: int, rows: Any) -> None:
        self.asked.append(('send', tick))

    def receive(self, rows: Any) -> None:
        self.asked.append('receive')
        rows.requests[:] = self.of_nodes

    def idle(self, seconds: float) -> None:
        self.asked.append(('idle', seconds))

    def snapshots(self) -> list[bytes]:
        return [b'haa', b'kfe']


class Mine(Controller):
    """It notes its calls among those of ``asked``."""

    def __init__(self, asked: list[Any], mark: str, wanted: Any = None) -> None:
        self.asked, self.mark = asked, mark
        self.wanted = {} if wanted is None else wanted

    def start(self, names: Any) -> None:
        self.asked.append((self.mark, 'start', names))

    def step(self, state: State) -> Any:
        self.asked.append((self.mark, 'step', state.t_ns, list(state.actuators),
                           list(state.supplies), float(state.actuators['kfe'].position)))
        return self.wanted() if callable(self.wanted) else self.wanted

    def snapshot(self) -> bytes:
        return self.mark.encode()

    def restore(self, snapshot: bytes) -> None:
        self.asked.append((self.mark, snapshot))


class Quiet(Controller):
    """It asks for nothing."""

    def step(self, state: State) -> Any:
        return {}


class Broken(Mine):
    """All of its methods fail but `step`."""

    def start(self, names: Any) -> None:
        raise KeyError('start')

    def snapshot(self) -> bytes:
        raise KeyError('snapshot')

    def restore(self, snapshot: bytes) -> None:
        raise KeyError('restore')


def rows() -> Any:
    samples = np.zeros(2, SAMPLE)
    samples['position'] = 0.1, 0.2
    return SimpleNamespace(samples=samples, supplies=np.zeros(1, SUPPLY_SAMPLE), bodies={},
                           requests=np.zeros(2, COMMAND))


def joined(*controllers: Controller, called: Any = (), others: Any = None) -> Any:
    """Return transport and rows after the start."""
    own = CallingTransport(others or Others(), controllers, NAMES, ['supply'], STEP_NS, called)
    of_run = rows()
    own.join(of_run)
    return own, of_run


def test_the_others_come_first_and_the_state_is_that_of_the_tick():
    others = Others()
    own, of_run = joined(Mine(others.asked, 'a'), Mine(others.asked, 'b'), others=others)
    own.begin()
    own.send(3, of_run)
    own.receive(of_run)
    own.idle(0.5)
    step = ('step', 3 * STEP_NS, NAMES, ['supply'], 0.2)
    assert others.asked == [
        'join', ('a', 'start', NAMES), ('b', 'start', NAMES), 'begin', ('send', 3),
        ('a', *step), ('b', *step), 'receive', ('idle', 0.5)]
    assert own.group is others.group


def test_a_request_lasts_for_one_tick_and_stands_over_that_of_a_node():
    others = Others()
    controller = Mine(others.asked, 'a', {'kfe': Setpoint(0.03)})
    own, of_run = joined(controller, others=others)
    others.of_nodes['position'], others.of_nodes['kinds'] = (0.5, 0.6), HAS_SETPOINT
    own.send(0, of_run)
    own.receive(of_run)
    assert of_run.requests['position'].tolist() == [0.5, 0.03]
    controller.wanted = {}
    own.send(1, of_run)
    own.receive(of_run)
    assert of_run.requests['position'].tolist() == [0.5, 0.6]


def test_of_two_controllers_the_last_wins():
    asked: list[Any] = []
    own, of_run = joined(Mine(asked, 'a', {'haa': Setpoint(0.01), 'kfe': Setpoint(0.02)}),
                         Mine(asked, 'b', {'kfe': Setpoint(0.04)}))
    own.send(0, of_run)
    own.receive(of_run)
    assert of_run.requests['position'].tolist() == [0.01, 0.04]


def test_an_effort_alone_keeps_the_place_that_the_actuator_has():
    own, of_run = joined(Mine([], 'a', {'kfe': Setpoint(effort=10.0, mode='force')}))
    own.send(0, of_run)
    own.receive(of_run)
    assert of_run.requests['position'][1] == 0.2


def test_states_are_saved_and_restored_behind_those_of_the_others():
    others = Others()
    own, of_run = joined(Mine(others.asked, 'a'), Mine(others.asked, 'b'), others=others)
    saved = own.snapshots()
    assert saved == [b'haa', b'kfe', b'a', b'b']
    others.asked.clear()
    own.restore(7, saved, of_run)
    assert others.asked == [('restore', 7, [b'haa', b'kfe']), ('a', b'a'), ('b', b'b')]
    own.restore(7, [b'node', *saved], of_run)       # of a run with a controller's node
    with pytest.raises(ConfigError, match='has 3 participants, the run has 4'):
        own.restore(7, saved[:3], of_run)


def fails() -> Any:
    raise KeyError('step')


@pytest.mark.parametrize(('call', 'words'), [
    (lambda own, of_run: own.join(of_run), r"^first\.start: KeyError: 'start'"),
    (lambda own, of_run: own.snapshots(), r"^first\.snapshot: KeyError: 'snapshot'"),
    (lambda own, of_run: own.restore(0, [b''] * 3, of_run),
     r"^first\.restore: KeyError: 'restore'")])
def test_a_failure_names_the_controller_and_its_method(call, words):
    own = CallingTransport(Others(), [Broken([], 'a')], NAMES, ['supply'], STEP_NS, ['first'])
    with pytest.raises(RunError, match=words):
        call(own, rows())


@pytest.mark.parametrize(('wanted', 'words'), [
    (fails, r"^Mine\.step at t = 0\.003 s: KeyError: 'step' \(test_calling\.py:"),
    ({'rom': Setpoint(0.1)}, r"^Mine\.step at t = 0\.003 s: 'rom' is not an actuator"),
    (3, r'^Mine\.step at t = 0\.003 s: 3 are no setpoints'),
    ({'kfe': Setpoint(float('nan'))},
     r'^Mine\.step at t = 0\.003 s: kfe: setpoint position = nan, must be finite '
     r'\(test_calling\.py:\d+\)$'),
    ({'kfe': Setpoint(np.float64('nan'))}, r' s: kfe: setpoint position = nan, must be finite ')])
def test_a_step_that_fails_or_returns_no_setpoints_names_its_time(wanted, words):
    """Of the second controller, which has no name in a run file: that of its class."""
    own, of_run = joined(Quiet(), Mine([], 'b', wanted), called=['first'])
    with pytest.raises(RunError, match=words):
        own.send(3, of_run)


def test_a_run_that_calls_none_has_the_transport_itself():
    others: Any = Others()
    run: Any = SimpleNamespace(called=())
    assert calling(run, others) is others
