"""A coordinator and two actuators in this process, driven tick by tick."""

from collections.abc import Iterator
from contextlib import contextmanager
import threading

from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ActuatorRole
from isa_ros.nodes.lockstep.steady_ticks import steady_ticks
import numpy as np
from tests.ros.lockstep.participants import make_transport, NAMES, rows_of_two


class Robot:
    """Two actuators with loads of their own on threads, and their coordinator."""

    def __init__(self, observer, ends: list[ParticipantEnd], nodes: list[ActuatorNode]) -> None:
        self.transport: LockstepTransport = make_transport(observer)
        self.ends, self.nodes, self.rows = ends, nodes, rows_of_two()
        starts = self.transport._run.starts
        starts['position'], starts['supply_pressure'] = (0.03, 0.04), 20.7e6
        self.join()

    def join(self) -> None:
        self.transport.join(self.rows)
        self.transport.begin()

    def tick(self, number: int, target: float | None = None) -> bytes:
        rows = self.rows
        rows.ports['supply_pressure'] = 20.7e6
        rows.commands['kinds'] = 0 if target is None else HAS_SETPOINT
        for name, value in ('position', target), ('stiffness', np.nan), ('damping', np.nan):
            rows.commands[name] = 0.0 if value is None else value
        self.transport.send(number, rows)
        self.transport.receive(rows)
        return rows.replies.tobytes() + rows.samples.tobytes() + rows.applied.tobytes()


@contextmanager
def driven(observer, is_looped: bool = True) -> Iterator[Robot]:
    is_over = threading.Event()
    nodes, ends = [], []
    for name in NAMES:
        setup = NodeSetup(default_actuator('isa_v5', name), DEFAULT_TIMING)
        node = ActuatorNode(lambda _, setup=setup: setup, name, has_mailbox=True,
                            context=observer.context, enable_rosout=False)
        role = ActuatorRole(node)
        role.digest = b'same'
        nodes.append(node)
        ends.append(ParticipantEnd(node, role, name,
                                   steady_ticks(node, role) if is_looped else None))
    threads = [threading.Thread(target=end.spin, args=(is_over.is_set,)) for end in ends]
    for thread in threads:
        thread.start()
    try:
        yield Robot(observer, ends, nodes)
    finally:
        is_over.set()
        for thread in threads:
            thread.join()
        for node in nodes:
            node.destroy_node()


def noted(outlet, is_subscribed: bool, messages: list[tuple[int, bytes]]) -> None:
    """Let an outlet note the messages that are kept; as with a subscription if there is one."""
    def note(given):
        messages.extend((slot, given[slot]) for slot, is_kept in enumerate(outlet._is_kept)
                        if is_kept and given[slot] is not None)

    def refresh():
        outlet._countdown, outlet.is_subscribed = 20, is_subscribed
    outlet.publish, outlet.refresh = note, refresh
