"""Command an actuator: one setpoint and what became of it, or one request to its device."""

from collections.abc import Callable, Mapping
import math
from typing import Any, NamedTuple

from isa_ros.core.device import MODES
from isa_ros.core.signals import HAS_REFERENCE, HAS_SETPOINT
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, one_line, RunError
from isa_ros.nodes.middleware.qos import KEPT, SETPOINT
from isa_ros.nodes.terminal.visitor import absolute, not_found, visiting, Visitor
from rcl_interfaces.msg import Log
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

APPLIED, WANTED = 'applied_setpoint', 'setpoint'
REQUESTS: Mapping[str, tuple[str, Any, Any]] = {
    'enable': ('enable', SetBool, SetBool.Request(data=True)),
    'disable': ('enable', SetBool, SetBool.Request(data=False)),
    'clear_fault': ('clear_fault', Trigger, Trigger.Request()),
    'quick_stop': ('quick_stop', Trigger, Trigger.Request())}
"""Request -> service of the actuator, its type and what is sent."""

_QUIET_S = 0.1          # without a message: those that a publisher keeps have arrived
_REJECTED = 'setpoint rejected: '
_ROSOUT_DEPTH = 100


class GivenSetpoint(NamedTuple):
    """A setpoint in SI; None: not given."""

    position: float | None
    velocity: float | None
    effort: float | None
    gains: Mapping[str, float]
    """By entry: stiffness, damping."""
    references: Mapping[str, float]
    """By entry: current, spool, pressure; the setpoint of that mode."""

    def message(self, entry: str) -> JointState:
        """Return it for the actuator that calls itself ``entry`` in its messages."""
        more = {**self.gains, **self.references}
        names, numbers = [f'{entry}/{name}' for name in more], list(more.values())
        if self.is_motion:
            names.insert(0, entry)
            numbers.insert(0, math.nan if self.position is None else self.position)
        return JointState(
            name=names, position=numbers,
            velocity=[] if self.velocity is None else [self.velocity],
            effort=[] if self.effort is None else [self.effort])

    @property
    def is_motion(self) -> bool:
        """Return whether it has position, velocity or effort."""
        return any(value is not None for value in (self.position, self.velocity, self.effort))


def request(actuator: str, what: str, timeout_s: float, print_line: Callable[[str], None]) -> bool:
    """
    Send one of `REQUESTS`, print the answer and return whether the device accepted it.

    Raises
    ------
    RunError
        The actuator did not appear, or did not answer, within the timeout.

    """
    path = absolute(actuator)
    service, kind, sent = REQUESTS[what]
    with visiting(timeout_s) as visitor:
        answer = visitor.ask('actuator', path, service, kind, sent, actuators)
    print_line(f'{path}: {one_line(answer.message)}')
    return bool(answer.success)


def command(actuator: str, wanted: GivenSetpoint, timeout_s: float,
            print_line: Callable[[str], None]) -> bool:
    """
    Send a setpoint, print what took effect from when on, and return whether it is followed.

    A device that is not enabled follows none; once it is, it holds the position that it then has.

    Raises
    ------
    ConfigError
        The actuator has rejected it.
    RunError
        The actuator did not appear, or applied none, within the timeout.

    """
    path = absolute(actuator)
    with visiting(timeout_s) as visitor:
        taken = _sent(visitor, path, wanted)
    stamp = taken.header.stamp
    t = stamp.sec + stamp.nanosec / NS_PER_SECOND
    is_followed = _entries(taken).get('enabled', 1.0) != 0.0
    print_line(f'{path}: {_shown(taken)}, from t = {t:.6f} s on'
               + ('' if is_followed else ', not followed: the device is not enabled'))
    return is_followed


def actuators(visitor: Visitor) -> list[str]:
    """Return the names of the actuators in the graph: those that publish applied setpoints."""
    end = f'/{APPLIED}'
    return [name.removesuffix(end) for name, _ in visitor.node.get_topic_names_and_types()
            if name.endswith(end) and visitor.node.count_publishers(name)]


def _sent(visitor: Visitor, path: str, wanted: GivenSetpoint) -> JointState:
    """Return the applied setpoint that came of a wanted one."""
    applied: list[JointState] = []
    rejections: list[str] = []
    logger = path[1:].replace('/', '.')

    def listen(log: Log) -> None:
        if log.name == logger and log.msg.startswith(_REJECTED):
            rejections.append(log.msg)
    node = visitor.node
    node.create_subscription(JointState, f'{path}/{APPLIED}', applied.append, KEPT)
    node.create_subscription(Log, '/rosout', listen, _ROSOUT_DEPTH)
    publisher = node.create_publisher(JointState, f'{path}/{WANTED}', SETPOINT)
    if not visitor.wait(lambda: applied and publisher.get_subscription_count()):
        raise not_found('actuator', path, actuators(visitor), visitor.seconds)
    _let_arrive(visitor, applied)
    entry = applied[-1].name[0]
    applied.clear()
    rejections.clear()
    publisher.publish(wanted.message(entry))
    is_there = visitor.wait(lambda: rejections or any(map(is_new, applied)))
    if rejections:
        raise ConfigError(one_line(f'{path}: {rejections[0]}'))
    if not is_there:
        raise RunError(
            f'actuator {path}: applied no setpoint within {visitor.seconds}; it may be paused, '
            'commanded by a scenario, or have rejected it: see its terminal')
    return next(filter(is_new, applied))


def _let_arrive(visitor: Visitor, applied: list[JointState]) -> None:
    """Wait for the kept messages of a publisher, at most as many as it keeps."""
    seen = 0
    while seen < len(applied) < KEPT.depth:
        seen = len(applied)
        visitor.wait(lambda: len(applied) > seen, _QUIET_S)


def is_new(message: JointState) -> bool:
    """Return whether a setpoint took effect, not only a mode or a state of the device."""
    return bool(int(_entries(message).get('changed', 0)) & (HAS_SETPOINT | HAS_REFERENCE))


def _entries(message: JointState) -> dict[str, float]:
    """Return the numbers of an applied setpoint by entry, the first without its name."""
    own = message.name[0]
    return {name.removeprefix(f'{own}/'): value
            for name, value in zip(message.name[1:], message.position[1:])}


def _shown(message: JointState) -> str:
    """Return what is in force: the number of its mode, or motion and gains."""
    entries = _entries(message)
    mode = MODES[int(entries['mode'])]
    if int(entries['changed']) & HAS_REFERENCE:
        return f'{mode} {entries["reference"]:.6g}'
    return (f'{mode}: position {message.position[0]:.6g}, velocity {message.velocity[0]:.6g}, '
            f'effort {message.effort[0]:.6g}, stiffness {entries["stiffness"]:.6g}, '
            f'damping {entries["damping"]:.6g}')
