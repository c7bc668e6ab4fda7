"""
How far an actuator goes whose valve cannot be commanded: a null that shifts by 2 mA.

With and without block valves and a supply that is dumped, alone and as the knee of a standing leg.
"""

from collections.abc import Mapping
from typing import Any

from isa_ros.text.table import markdown
import numpy as np
from scripts.measure_leg_stops import placed, trunk
from scripts.measure_stops import ACCUMULATOR, advance, rig, simulation_of

SHIFT_MA = 2.0
POPPET: Mapping[str, Any] = {'kind': 'poppet'}
DUMPED: Mapping[str, Any] = {
    'supply': {**ACCUMULATOR, 'dump': {'kind': 'valve'}},
    'emergency_stops': {'all': {'actuators': ['ram'], 'dumps': 'at_once'}}}
HELD: Mapping[str, Any] = {'supply': ACCUMULATOR}
ALONE: Mapping[str, tuple[bool, float, Mapping[str, Any]]] = {
    'constant supply': (False, 50.0, {}),
    'constant supply, block valves, trip after 50 ms': (True, 50.0, {}),
    'constant supply, block valves, trip after 10 ms': (True, 10.0, {}),
    'accumulator, trip after 10 ms': (False, 10.0, HELD),
    'accumulator, dump at once, trip after 10 ms': (False, 10.0, DUMPED),
    'accumulator, block valves, trip after 10 ms': (True, 10.0, HELD),
    'accumulator, dump at once, block valves, trip after 10 ms': (True, 10.0, DUMPED)}
"""Block valves or none, delay of `spool_deviation` in ms, and keys of the run file, by name."""
KNEE: Mapping[str, tuple[bool, float]] = {
    'knee, no block valves': (False, 50.0),
    'knee, block valves, trip after 50 ms': (True, 50.0),
    'knee, block valves, trip after 10 ms': (True, 10.0)}


def _reu(has_block: bool, delay_ms: float) -> dict[str, Any]:
    return {'protection': {'spool_deviation': {
        'delay_ms': delay_ms, 'reaction': 'block' if has_block else 'disable'}}}


def alone_table() -> list[str]:
    """Return the lines of the table of an ISA v5 with 50 kg at rest, 1 s after the shift."""
    rows = [('50 kg at mid stroke', 'farthest', 'then moves by', 'chambers A and B then')]
    for name, (has_block, delay_ms, run) in ALONE.items():
        own: dict[str, Any] = {'reu': _reu(has_block, delay_ms)}
        if has_block:
            own['plant'] = {'block_valve': POPPET}
        simulation = simulation_of({**rig(parameters=own), **run})
        simulation.command('ram', position=0.05, stiffness=1e5, damping=4000.0)
        start = advance(simulation, 0.3)[-1, 0]
        simulation.tune('ram', {'plant.spool.null_bias.current_ma': SHIFT_MA})
        way = 1e3 * (advance(simulation, 1.0)[:, 0] - start)
        sample = simulation.samples['ram']
        rows.append((name, f'{way.max():.1f} mm', f'{np.ptp(way[-500:]):.2f} mm in 0.1 s',
                     f'{1e-6 * sample.pressure_a:.1f}, {1e-6 * sample.pressure_b:.1f} MPa'))
    return markdown(rows)


def knee_table() -> list[str]:
    """Return the lines of the table of the leg's trunk, mm, within 1 s after the shift."""
    rows = [('standing leg', 'null', 'lowest and highest in 1 s', 'after 1 s')]
    for name, (has_block, delay_ms) in KNEE.items():
        changes: dict[str, Any] = {
            f'actuators.kfe.parameters.reu.protection.spool_deviation.{key}': value
            for key, value in _reu(has_block, delay_ms)['protection']['spool_deviation'].items()}
        if has_block:
            changes['actuators.kfe.parameters.plant.block_valve'] = POPPET
        for shift in (-SHIFT_MA, SHIFT_MA):
            simulation, _ = placed({}, 0.0, changes)
            height = float(simulation.body_sample.height)  # type: ignore[union-attr]
            simulation.tune('kfe', {'plant.spool.null_bias.current_ma': shift})
            heights = 1e3 * (trunk(simulation, 1.0)[0] - height)
            rows.append((name, f'{shift:+g} mA', f'{heights.min():+.0f}, {heights.max():+.0f} mm',
                         f'{heights[-1]:+.0f} mm'))
    return markdown(rows)
