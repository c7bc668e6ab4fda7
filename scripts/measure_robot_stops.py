"""The standing quadruped, all of whose actuators stop at the same time, and what it sinks then."""

from collections.abc import Mapping
from typing import Any

from isa_ros.core.device import DISABLED
from isa_ros.scripting.run import load
from isa_ros.text.table import markdown

STOPPED = 1.0                   # s, of the scenario quadruped_stand
AFTER = (0.25, 1.0, 4.0)        # s
ROBOTS: Mapping[str, Mapping[str, Any]] = {
    'quadruped': {},
    'quadruped, block valves': {'plant.block_valve': {'kind': 'poppet'}}}


def robot_table() -> list[str]:
    """Return the lines of the table of the trunk's height after an emergency stop of all."""
    rows = [('standing robot', 'outputs off after', *(f'after {after:g} s' for after in AFTER))]
    return markdown([*rows, *(_row(name, own) for name, own in ROBOTS.items())])


def _row(name: str, parameters: Mapping[str, Any]) -> tuple[str, ...]:
    names = [own.name for own in load('quadruped').configuration.actuators]
    simulation = load('quadruped', 'quadruped_stand', changes={
        f'actuators.{own}.parameters.{key}': value
        for own in names for key, value in parameters.items()}).simulation()
    while simulation.t < STOPPED:
        simulation.step()
    body: Any = simulation.body_sample
    before, off, found = float(body.position[2]), '', []
    simulation.emergency_stop()
    for after in AFTER:
        while simulation.t < STOPPED + after:
            simulation.step()
            if not off and all(own.device_state == DISABLED
                               for own in simulation.samples.values()):
                off = f'{simulation.t - STOPPED:.2f} s'
        found.append(f'{1e3 * (float(body.position[2]) - before):+.1f} mm')
    return name, off, *found
