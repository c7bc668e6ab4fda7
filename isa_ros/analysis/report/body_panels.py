"""Panels of what several actuators move: joints, contacts, pose; from the fields of its sample."""

from collections.abc import Iterator, Mapping, Sequence

from isa_ros.analysis.report.panels import columns, Curve, Group, Panel
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.body_config import BODY, BodyConfig
from isa_ros.core.fields import Field
from isa_ros.surroundings.messages import JOINT_STATES, JointStates
import numpy as np

_AXES: Mapping[int, Sequence[str]] = {3: 'xyz', 4: 'wxyz'}
_MOST_CURVES = 6
_SHOWN = {'rad': 'deg', 'rad/s': 'deg/s'}
_CAPTIONS = {
    'foot_force': 'From the ground on the foot, in the axes of the world: 0 in the air, a peak at '
                  'touch-down, the weight at rest.',
    'specific_force': 'As an inertial unit reads it: at rest it points up, 9.81 m/s2.',
    'force': 'From the ground or another body, as far as it touches.',
    'torque': 'Of all actuators on the joint.',
    'orientation': 'As a quaternion.'}


def body_group(body: BodyConfig, signals: Signals) -> Group:
    """Return the panels of a body; what was not recorded is left out."""
    panels: list[Panel] = []
    scalars: dict[tuple[str, str], list[str]] = {}
    for field in body.fields:
        name = f'{body.name}.{field.name}'
        if name not in signals:
            continue
        if field.shape:
            panels += _vector(_joints_of(body, field, signals.run.step_ns), field.name,
                              signals.over_time(name), field.unit)
        else:
            scalars.setdefault((_kind(field.name), field.unit), []).append(field.name)
    for (kind, unit), names in scalars.items():
        for group in _in_groups(names):
            panels.append(_panel(_title(kind, group), unit, _caption(kind), [
                Curve(_short(name, kind), signals.over_time(f'{body.name}.{name}'))
                for name in group]))
    return Group(body.kind if body.name == BODY else body.name, body.called.removeprefix('the '),
                 sorted(panels, key=_rank), [actuator for _, actuator in body.joints])


def _rank(panel: Panel) -> int:
    """Return the order of panels: joints, then contacts, then all others."""
    if 'joint' in panel.title:
        return 0
    return 1 if 'force' in panel.title or 'torque' in panel.title else 2


def _joints_of(body: BodyConfig, field: Field, step_ns: int) -> list[str]:
    """
    Return the joints of each number of a field, as the messages of the body say; none has any: [].

    A number without one is called by its place. Joints that move together share one.
    """
    joints: dict[str, list[str]] = {}
    for message in body.messages(step_ns):
        if isinstance(message, JointStates) and message.topic.endswith(JOINT_STATES):
            for columns_of in (message.position, message.velocity, message.effort):
                for name, column in zip(message.names, columns_of):
                    joints.setdefault(column, []).append(name.removesuffix('_joint').upper())
    own = [f'{field.name}[{k}]' for k in range(field.shape[0])]
    return [', '.join(joints.get(column, [str(k)])) for k, column in enumerate(own)] if (
        joints.keys() & set(own)) else []


def _vector(joints: Sequence[str], name: str, signal: Signal, unit: str) -> Iterator[Panel]:
    """Yield the panels of a field of several numbers; two units are two panels."""
    units, n = unit.split(', '), signal.values.shape[1]
    size = n // len(units)
    axes = _AXES.get(size, [str(k) for k in range(size)])
    for k, own in enumerate(units):
        labels = joints[k * size:(k + 1) * size] or axes
        part = Signal(signal.t, signal.values[:, k * size:(k + 1) * size])
        words = f'{"joint " if joints else ""}{name}'.replace('_', ' ')
        yield _panel(f'{words}{_PARTS.get(own, "") if len(units) > 1 else ""}', own,
                     _caption(name), columns(part, labels))


_PARTS = {'N': ', force', 'Nm': ', moment', 'm/s': ', linear', 'rad/s': ', angular'}


def _panel(title: str, unit: str, caption: str, curves: Sequence[Curve]) -> Panel:
    shown = _SHOWN.get(unit, unit)
    scale = float(np.radians(1.0)) if shown != unit else 1.0
    return Panel(title, '' if shown == '1' else shown, scale, curves, caption)


def _kind(name: str) -> str:
    """Return the last word of a field: lf_haa_position has ``position``."""
    return name.rpartition('_')[2]


def _short(name: str, kind: str) -> str:
    """Return a field without its last word, as far as it has others."""
    return name.removesuffix(f'_{kind}') or name


def _title(kind: str, names: Sequence[str]) -> str:
    if len(names) == 1:
        return names[0].replace('_', ' ')
    return f'joint {kind}' if kind in ('position', 'velocity', 'torque') else kind


def _caption(name: str) -> str:
    return next((text for key, text in _CAPTIONS.items() if name.endswith(key)), '')


def _in_groups(names: Sequence[str]) -> list[list[str]]:
    """Return names that share a panel: all of a few, else those with the same first word."""
    if len(names) <= _MOST_CURVES:
        return [[*names]]
    by_word: dict[str, list[str]] = {}
    for name in names:
        by_word.setdefault(name.partition('_')[0], []).append(name)
    if max(map(len, by_word.values())) > 1:
        names = [name for group in by_word.values() for name in group]
        if all(len(group) <= _MOST_CURVES for group in by_word.values()):
            return [*by_word.values()]
    return [[*names[k:k + _MOST_CURVES]] for k in range(0, len(names), _MOST_CURVES)]
