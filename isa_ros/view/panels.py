"""
The diagrams of a run as data: what each source shows, by the names of channels.

A channel is SOURCE.FIELD of a result, or SOURCE.FIELD[k] for a number of several.
"""

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from isa_ros.analysis.signals import diagrams
from isa_ros.config.runs.body_config import BODY, BodyConfig
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.units import MILLI, MPA
from isa_ros.surroundings.messages import Force
from isa_ros.view.nodes import SceneNode
import numpy as np

_DEGREE = float(np.radians(1.0))
_XYZ = 'xyz'

Curve = diagrams.Curve[str]
Panel = diagrams.Panel[str]
Group = diagrams.Group[str]


def groups_of(run: RunConfig) -> list[Group]:
    """Return the groups of a run, actuators first."""
    supplies = {name: supply.sampled_at(name) for supply in run.supplies for name in supply.feeds}
    return [*(_actuator(own, supplies[own.name]) for own in run.actuators),
            *(group for body in run.bodies if (group := _body(body, run.step_ns)).panels)]


def recorded(groups: Iterable[Group], channels: Container[str]) -> list[Group]:
    """Return groups without curves, panels and groups of which no channel is there."""
    found = [replace(group, panels=diagrams.kept(group.panels, channels.__contains__))
             for group in groups]
    return [group for group in found if group.panels]


def channels_of(groups: Iterable[Group], nodes: Iterable[SceneNode]) -> list[str]:
    """Return the channels of groups and scene, each once."""
    names = [curve.signal for group in groups for panel in group.panels for curve in panel.curves]
    names += [channel for node in nodes for channel in node.channels]
    return [*dict.fromkeys(names)]


def tree_of(groups: Iterable[Group], place_of: dict[str, int]) -> list[dict[str, Any]]:
    """Return groups for JSON; ``place_of`` are the places of the channels in a frame."""
    return [{'name': group.name, 'title': group.title, 'panels': [{
        'label': panel.label, 'scale': panel.scale, 'curves': [{
            'label': own.label, 'channel': place_of[own.signal], 'dash': own.is_reference}
            for own in panel.curves]} for panel in group.panels]} for group in groups]


def _actuator(actuator: ActuatorConfig, supply: str) -> Group:
    is_rotary, name = actuator.sheet.is_rotary, actuator.name

    def pair(field: str, title: str, unit: str, scale: float) -> Panel:
        return Panel(title, unit, scale, [
            Curve('measured', f'{name}.{field}'),
            Curve('reference', f'{name}.{field}_reference', is_reference=True)])
    return Group(name, f'{name} ({actuator.model})', [
        pair('position', 'position', *(('deg', _DEGREE) if is_rotary else ('mm', MILLI))),
        pair('force', *(('torque', 'Nm') if is_rotary else ('force', 'N')), 1.0),
        Panel('pressure', 'MPa', MPA, [
            Curve('A', f'{name}.pressure_a'), Curve('B', f'{name}.pressure_b'),
            Curve('supply', f'{supply}.pressure', is_reference=True)]),
        pair('spool', 'spool', 'mm', MILLI),
        pair('current', 'current', 'mA', MILLI)])


def _body(body: BodyConfig, step_ns: int) -> Group:
    """Return the contact forces of a body: of one all axes, of several those upwards."""
    forces = [own for own in body.messages(step_ns) if isinstance(own, Force)]
    panels = [Panel('contact force', 'N', 1.0, [*_contacts(body, forces)])] if forces else []
    return Group(body.name, body.kind if body.name == BODY else body.name, panels)


def _contacts(body: BodyConfig, forces: Sequence[Force]) -> Iterator[Curve]:
    if len(forces) == 1:
        for axis, column in zip(_XYZ, forces[0].force):
            yield Curve(axis, f'{body.name}.{column}')
        return
    for own in forces:
        yield Curve(f'{own.frame} {_XYZ[-1]}', f'{body.name}.{own.force[-1]}')
