"""What a layout shows of a run: pages of diagrams of curves, whatever tool draws them."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.surroundings.messages import BodyMessage, Force, Inertial, JointStates, Odometry
from msg_adapters.coordinator_messages import supply_topic

MEASURED, REFERENCE, SECOND = '#1f77b4', '#ff7f0e', '#2ca02c'
COLOURS = (
    MEASURED, REFERENCE, SECOND, '#d62728', '#9467bd', '#8c564b', '#e377c2', '#7f7f7f', '#bcbd22',
    '#17becf', '#393b79', '#637939')

SUPPLIES = (('pressure', 'fluid_pressure', 'supply, Pa'),
            ('temperature', 'temperature', 'supply, degrees Celsius'))
"""End of a signal's name, its field, and what its diagram is called."""


class TopicCurve(NamedTuple):
    """One number of the messages of a topic."""

    topic: str
    path: str
    """In the message, as Python has it: ``position[0]``, ``wrench.force.z``."""
    field: str
    """Behind the topic, as PlotJuggler has it: an entry of a JointState by its name."""
    label: str
    colour: str


class Diagram(NamedTuple):
    """Curves over the time, on one axis."""

    title: str
    """What, and its unit."""
    curves: Sequence[TopicCurve]


class LayoutPage(NamedTuple):
    """Diagrams below each other."""

    title: str
    diagrams: Sequence[Diagram]


def pages_of(run: RunConfig) -> list[LayoutPage]:
    """Return a page for all bodies and supplies, if it has any diagram, and one an actuator."""
    whole = [diagram for body in run.bodies
             for diagram in _of_body(body.messages(run.step_ns))]
    for kind, field, title in SUPPLIES:
        found = [(name, signal) for name, signals in run.sampled_supplies for signal in signals
                 if signal.endswith(kind)]
        if found:
            whole.append(Diagram(title, [
                _plain(supply_topic(name, signal), field, f'{name} {signal}', k)
                for k, (name, signal) in enumerate(found)]))
    return [*([LayoutPage('machine', whole)] if whole else ()),
            *(_of_actuator(own.name, own.sheet.is_rotary) for own in run.actuators)]


def state_of(actuator: str) -> tuple[str, str]:
    """Return the topic of an actuator's device, and the path of the word for its state."""
    return f'/{actuator}/device', 'values[0].value'


def _of_actuator(name: str, is_rotary: bool) -> LayoutPage:
    length, force = ('rad', 'Nm') if is_rotary else ('m', 'N')
    joint, valve, references = (
        f'/{name}/{suffix}' for suffix in ('joint_states', 'valve', 'references'))
    loops = [_entry(references, f'{name}/{loop}', k, 'position', 'reference', REFERENCE)
             for k, loop in enumerate(('position', 'force', 'spool', 'current'))]
    return LayoutPage(name, [
        Diagram(f'position, {length}', [
            _entry(joint, name, 0, 'position', 'measured', MEASURED), loops[0]]),
        Diagram(f'force, {force}', [
            _entry(joint, name, 0, 'effort', 'measured', MEASURED), loops[1]]),
        Diagram('pressure, Pa', [
            _plain(f'/{name}/pressure_a', 'fluid_pressure', 'A', 0),
            _plain(f'/{name}/pressure_b', 'fluid_pressure', 'B', 1)]),
        Diagram('spool, m', [
            _entry(valve, f'{name}/spool', 0, 'position', 'measured', MEASURED), loops[2]]),
        Diagram('current, A', [
            _entry(valve, f'{name}/spool', 0, 'effort', 'measured', MEASURED), loops[3]])])


def _of_body(messages: Sequence[BodyMessage]) -> Iterator[Diagram]:
    forces = [message for message in messages if isinstance(message, Force)]
    if forces:
        yield Diagram('ground pushes up, N', [
            _plain(own.topic, 'wrench.force.z', own.topic.strip('/'), k)
            for k, own in enumerate(forces)])
    for message in messages:
        if isinstance(message, JointStates):
            for array, title in ('position', 'joints, rad or m'), ('effort', 'joints, Nm or N'):
                yield Diagram(title, [
                    _entry(message.topic, name, k, array, name, COLOURS[k % len(COLOURS)])
                    for k, name in enumerate(message.names)])
        elif isinstance(message, Odometry):
            yield Diagram('height, m', [_plain(message.topic, 'pose.pose.position.z', 'z', 0)])
            yield Diagram('speed in its own axes, m/s', [
                _plain(message.topic, f'twist.twist.linear.{axis}', axis, k)
                for k, axis in enumerate('xyz')])
        elif isinstance(message, Inertial):
            yield Diagram('specific force, m/s2', [
                _plain(message.topic, f'linear_acceleration.{axis}', axis, k)
                for k, axis in enumerate('xyz')])


def _plain(topic: str, path: str, label: str, k: int) -> TopicCurve:
    """Return a field of a message; ``k`` is its place in its diagram."""
    return TopicCurve(topic, path, '/' + path.replace('.', '/'), label, COLOURS[k % len(COLOURS)])


def _entry(topic: str, name: str, k: int, array: str, label: str, colour: str) -> TopicCurve:
    """Return entry ``k`` of a JointState, whose name there is ``name``."""
    return TopicCurve(topic, f'{array}[{k}]', f'/{name}/{array}', label, colour)
