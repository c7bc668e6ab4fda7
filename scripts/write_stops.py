"""
Write the tables of stops in docs/protection.md: every situation, run and measured.

Two minutes:

    python -m scripts.write_stops
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.config.text.yaml_text import Tree
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
from scripts.measure_leg_stops import LEG_SITUATIONS, LEGS, trunk
from scripts.measure_robot_stops import robot_table
from scripts.measure_stops import (
    accelerate, ACCUMULATOR, advance, rig, simulation_of, stop, Stopped)
from scripts.measure_valve_faults import alone_table, knee_table

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'protection.md'
HEADER = ('situation', 'v', 'largest v', 'v^2/2a + v T', 'of the largest', 'travel', 'back',
          'largest force', 'swing at rest')
MM, NEWTON = ('mm', 1e3, 'm/s', 'N'), ('mrad', 1e3, 'rad/s', 'Nm')
STIFF: Mapping[str, Any] = {'position': 0.07, 'stiffness': 3e5, 'damping': 4000.0}
FORCE: Mapping[str, Any] = {'mode': 'force', 'position': 0.05}
CYLINDER: Tree = {'plant': {
    'drive': {'bore_mm': 40.0, 'rod_mm': 25.0, 'stroke_mm': 200.0, 'rated_pressure_mpa': 14.0},
    'valve': {'flow': {'rated_flow_lpm': 20.0, 'rated_current_ma': 10.0}}}}


class Situation(NamedTuple):
    """A load that is moved until it has a speed, and then stopped."""

    name: str
    config: Tree
    command: Mapping[str, Any]
    speed: float
    """m/s | rad/s, as estimated; 0: at rest after 0.1 s."""
    is_rotary: bool = False


def situations() -> Iterator[Situation]:
    """Yield every situation of a single actuator."""
    for mass in (5.0, 20.0, 50.0, 200.0, 500.0):
        name = f'ISA v5, {mass:g} kg'
        yield Situation(f'{name}, impedance', rig(mass=mass, position=0.2), STIFF, 0.25)
        yield Situation(f'{name}, force 5000 N', rig(mass=mass, position=0.1),
                        {**FORCE, 'effort': 5000.0}, 0.4 if mass < 100.0 else 0.3)
        yield Situation(f'{name}, force -2000 N', rig(mass=mass, position=0.9),
                        {**FORCE, 'effort': -2000.0}, 0.4 if mass < 100.0 else 0.3)
    yield Situation('ISA v5, 50 kg lifts 4000 N', rig(force=-4000.0, position=0.2),
                    {**STIFF, 'effort': 4000.0}, 0.25)
    yield Situation('ISA v5, 50 kg bears 4000 N', rig(force=-4000.0),
                    {'position': 0.05, 'effort': 4000.0}, 0.0)
    yield Situation('ISA v5, 50 kg, towards the end', rig(position=0.6),
                    {**FORCE, 'effort': 5000.0}, 0.8)
    for variant in ('explicit', 'position_control', 'feedback_linearisation', 'pressure_control',
                    'valve_amplifier', 'data_sheet_sensors'):
        command: Mapping[str, Any] = {
            'position_control': {'position': 0.04}, 'pressure_control': {
                'position': 0.05, 'effort': 2e6},
            'valve_amplifier': {'position': 0.05, 'effort': 2e-3}}.get(variant, STIFF)
        yield Situation(f'ISA v5, 50 kg, `{variant}`', rig(variants=(variant,), position=0.2),
                        command, 0.2)
    yield Situation('ISA v5, 50 kg, accumulator', rig(supply=ACCUMULATOR, position=0.1),
                    {**FORCE, 'effort': 5000.0}, 0.4)
    yield Situation('ISA v5, 50 kg, 10 MPa', rig(supply_mpa=10.0, position=0.2), STIFF, 0.25)
    yield Situation('ISA v2, 50 kg', rig('isa_v2', position=0.1, stroke=0.08),
                    {**STIFF, 'stiffness': 2e4, 'damping': 1e3}, 0.4)
    yield Situation('cylinder 40/25 mm, 14 MPa, 50 kg',
                    rig('cylinder', position=0.2, stroke=0.2, supply_mpa=14.0,
                        parameters=CYLINDER), {'position': 0.15}, 0.15)
    yield Situation('smart manifold, wheel',
                    rig('smart_manifold', load_kind='wheel', position=0.3, stroke=1.745),
                    {'position': 1.2}, 1.5, True)


def measured(one: Situation) -> Stopped:
    """Return how the stop of a situation went, until its outputs were off."""
    simulation = simulation_of(one.config)
    simulation.command('ram', **one.command)
    if one.speed:
        accelerate(simulation, one.speed)
    else:
        advance(simulation, 0.1)
    return stop(simulation, 0.4)


def table() -> list[str]:
    """Return the lines of the table of single actuators."""
    return markdown([HEADER, *(_cells(one, measured(one)) for one in situations())])


def _cells(one: Situation, found: Stopped) -> tuple[str, ...]:
    unit, size, speed, force = NEWTON if one.is_rotary else MM
    return (one.name, f'{abs(found.speed):.2f} {speed}', f'{found.peak_speed:.2f} {speed}',
            f'{size * found.expected:.1f} {unit}', f'{size * found.expected_of_peak:.1f} {unit}',
            f'{size * found.travel:.1f} {unit}', f'{size * found.bounce:.2f} {unit}',
            f'{found.peak_force:.0f} {force}', f'{found.swing:.0f} {force}')


def leg_table() -> list[str]:
    """Return the lines of the table of the leg's trunk, mm, after all its actuators stop."""
    rows = [('leg', 'trunk at the command', 'lowest and highest in 250 ms', 'force on the foot')]
    for name, prepare in LEG_SITUATIONS.items():
        simulation, speed = prepare()
        height = float(simulation.body_sample.height)  # type: ignore[union-attr]
        for own in LEGS:
            simulation.command(own, quick_stop=True)
        heights, forces = trunk(simulation, 0.25)
        rows.append((name, f'{speed:.2f} m/s',
                     f'{1e3 * (heights.min() - height):+.2f}, '
                     f'{1e3 * (heights.max() - height):+.2f} mm',
                     f'{forces.min():.0f} to {forces.max():.0f} N'))
    return markdown(rows)


def main() -> None:
    """Write the page."""
    text = PAGE.read_text(encoding='utf-8')
    PAGE.write_text(with_parts(text, {
        'stops': table(), 'leg stops': leg_table(), 'robot stops': robot_table(),
        'valve faults': alone_table(),
        'knee faults': knee_table()}), encoding='utf-8')
    print(PAGE)


if __name__ == '__main__':
    main()
