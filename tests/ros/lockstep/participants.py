"""A coordinator's transport, and participants on threads."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
import threading
import time

from isa_ros.actuator.rows import memory_of
from isa_ros.controller import Controller, Setpoint
from isa_ros.core.signals import HAS_ENABLE, HAS_SETPOINT, START
from isa_ros.errors import SimulationDiverged
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.expected import Expected, Limits, Participants
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ActuatorRole, ControllerRole
from isa_ros.run.wire.roster import Roster
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import Rows
import numpy as np
from rclpy.node import Node

DEADLINE_S = 20.0  # without processes to start and kernels to compile
PATIENT = Limits(join_s=DEADLINE_S, tick_s=DEADLINE_S)
NAMES = ('haa', 'kfe')


class Cart:
    """A body of which only its sample matters."""

    sample = np.zeros(1, [('height', '<f8')])


class Outside:
    """Surroundings of which only what they show matters."""

    def __init__(self, has_body: bool) -> None:
        self.supplies = np.zeros(1, SUPPLY_SAMPLE)
        self.has_supply_ports = False
        self.bodies = {'cart': Cart()} if has_body else {}


def rows_of_two(has_body: bool = False) -> Rows:
    """Return the memory of a run of `NAMES`."""
    return Rows(2, Outside(has_body))


class Scripted:
    """An actuator that returns the received values; its position counts its ticks."""

    def __init__(self, digest: str = 'same') -> None:
        self.digest = digest
        self.actuator = self    # its node and itself
        self.memory = memory_of(1)
        self.applied_parameters: Mapping[str, float] = {}
        self.target = 0.0
        self.starts = 0
        self.ticks = 0
        self.published: list[float] = []
        self.changes: list[dict[str, float]] = []
        self.fails_at = -1
        self.error: Exception = SimulationDiverged(7_000_000, 'kfe: spool', float('inf'))
        self.is_late_at = -1
        self.released = threading.Event()
        self.pause_s = 0.0

    def tune(self, values: Mapping[str, float]) -> None:
        self.changes.append(dict(values))

    def start(
            self, position: float, force: float, supply_pressure: float,
            return_pressure: float) -> None:
        self.starts += 1
        self.ticks = 0
        self.memory.observed['position'] = position
        self._apply(HAS_SETPOINT | HAS_ENABLE, {})

    def accept(self, command: np.void) -> None:
        self.target = float(command['position'])

    def tick(self, port: np.void) -> None:
        tick, self.ticks = self.ticks, self.ticks + 1
        if tick == self.fails_at:
            raise self.error
        time.sleep(self.pause_s)
        if tick == self.is_late_at:
            self.released.wait(DEADLINE_S)
        self.memory.replies['force'] = port['x0'] + self.target
        self.memory.observed['position'] += 1.0
        self._apply(*(HAS_SETPOINT, {'force.kp': 1e-7}) if tick == 1 else (0, {}))

    def _apply(self, kinds: int, tuned: Mapping[str, float]) -> None:
        applied = self.memory.applied
        applied['kinds'], applied['position'] = kinds, self.memory.observed['position']
        self.applied_parameters = tuned

    def snapshot(self) -> bytes:
        time.sleep(self.pause_s)
        return b'after %d' % self.ticks

    def restore(self, snapshot: bytes) -> None:
        self.ticks = int(snapshot.split()[1])
        self.memory.observed['position'] = 100.0 + self.ticks
        self._apply(HAS_ENABLE, {'force.kf': float(self.ticks)})

    def publish(self) -> None:
        self.published.append(float(self.memory.observed['position'][0]))

    def serve(self) -> None:
        pass


class Follower(Controller):
    """Commands HAA to the position of KFE, and keeps the states it received."""

    def __init__(self) -> None:
        self.shown: list[tuple[int, list[float]]] = []
        self.supplies: list[dict[str, float]] = []
        self.heights: list[float | None] = []
        self.setpoints: dict[str, Setpoint] | None = None

    def start(self, names: Sequence[str]) -> None:
        self.names = list(names)

    def step(self, state) -> dict[str, Setpoint]:
        positions = [float(own.position) for own in state.actuators.values()]
        self.shown.append((state.t_ns, positions))
        self.supplies.append({name: float(own.pressure) for name, own in state.supplies.items()})
        self.heights.append(None if state.body is None else float(state.body.height))
        return {'haa': Setpoint(positions[1])} if self.setpoints is None else self.setpoints


@contextmanager
def spinning(context, steppers: dict[str, Scripted | Controller]) -> Iterator[None]:
    """Take part with these names while the context lasts."""
    is_over = threading.Event()
    nodes = [Node(name, context=context, enable_rosout=False, start_parameter_services=False)
             for name in steppers]
    threads = [
        threading.Thread(target=ParticipantEnd(node, role(stepper)).spin, args=(is_over.is_set,))
        for node, stepper in zip(nodes, steppers.values())]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        is_over.set()
        for stepper in steppers.values():
            if isinstance(stepper, Scripted):
                stepper.released.set()
        for thread in threads:
            thread.join()
        for node in nodes:
            node.destroy_node()


def role(stepper: Scripted | Controller) -> ActuatorRole | ControllerRole:
    return ActuatorRole(stepper) if isinstance(stepper, Scripted) else ControllerRole(stepper)


def make_transport(
        node: Node, controllers: Sequence[str] = (), limits: Limits = PATIENT,
        watch: Callable[[], str | None] = lambda: None,
        should_stop: Callable[[], bool] = lambda: False, first_remote: int = 0,
        has_body: bool = False) -> LockstepTransport:
    starts = np.zeros(2, START)
    starts['position'] = 0.25, 0.5
    expected = [*(Expected(name, 'same') for name in NAMES),
                *(Expected(name, '') for name in controllers)]
    roster = Roster([own.name for own in expected], ['supply'],
                    {'cart': Cart.sample.dtype} if has_body else {})
    return LockstepTransport(
        node, Participants(expected, roster, starts, 1_000_000, first_remote), limits,
        watch=watch, should_stop=should_stop)


def begin(transport: LockstepTransport, rows: Rows | None = None) -> Rows:
    """Return the rows before tick 0."""
    rows = rows_of_two() if rows is None else rows
    transport.join(rows)
    transport.begin()
    return rows


def tick(
        transport: LockstepTransport, number: int, rows: Rows | None = None) -> list[float]:
    """Return the reply forces of one tick."""
    rows = rows_of_two() if rows is None else rows
    rows.ports['x0'] = 1.0, 2.0
    rows.commands['kinds'], rows.commands['position'] = HAS_SETPOINT, number
    transport.send(number, rows)
    transport.receive(rows)
    return rows.replies['force'].tolist()


def applied(rows: Rows) -> list[tuple[int, float]]:
    """Return (kinds, position) of what took effect at each actuator."""
    return list(zip(rows.applied['kinds'].tolist(), rows.applied['position'].tolist()))


def is_by_socket(end: LockstepTransport | ParticipantEnd) -> bool:
    """Return whether this end sends its ticks or answers by socket."""
    return end._wires.is_open if isinstance(end, LockstepTransport) else end._wire is not None
