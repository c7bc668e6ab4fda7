"""
The supply's port against one ODE of the supply and twelve actuators; with --write into docs.

    python -m scripts.measure_supply_port --write
"""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.rows import memory_of, row_of
from isa_ros.analysis.accuracy.one_circuit import pressures
from isa_ros.config.assembly import timing_of
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.signals import COMMAND
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.core.units import MPA
from isa_ros.scripting.run import load, Run
from isa_ros.surroundings.accumulator import supply_record
from isa_ros.text.marked import with_parts
import numpy as np

PAGE = Path(__file__).parents[1] / 'docs' / 'parts.md'
N = 12
VOLUMES_ML = (20.0, 50.0, 200.0, 500.0)
DURATION_S = 0.6
MOTIONS: Mapping[str, Any] = {
    'all together': lambda k: (10.0, 2.0, 0.05),
    'in two groups, as a trot': lambda k: (10.0, 2.0, 0.05 + 0.25 * (k % 2)),
    'each its own': lambda k: (4.0 + k, 1.0 + 0.25 * k, 0.05 + 0.01 * k),
    'one, the others hold': lambda k: (20.0, 2.0, 0.05) if k == 0 else (0.0, 1.0, 0.05)}
"""Amplitude (mm), frequency (Hz) and start (s) of the sine of actuator k, by name."""


class PressureDifference(NamedTuple):
    """A run against one ODE: pressures in Pa."""

    rms: float
    greatest: float
    least: float
    most: float


def tree_of(volume_ml: float, port: str, motion: str) -> tuple[Tree, Tree]:
    """Return run file and scenario of twelve cylinders on a manifold without accumulator."""
    supply: Tree = {
        'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0,
        'gas_volume_l': 0.32, 'precharge_mpa': 60.0,    # above any pressure: empty
        'polytropic_exponent': 1.3, 'line_volume_l': 1e-3 * volume_ml, 'bulk_modulus': 1.0e9,
        'pump_flow_lpm': 60.0, 'pump_lag_s': 0.03, 'pump_band_mpa': 0.5, 'relief_mpa': 22.5,
        'relief_lpm_per_mpa': 10.0, 'port': {'kind': port}}
    run: Tree = {
        'name': 'supply_port', 'step_ms': 1.0, 'controller_offset_ms': 0.12,
        'tick_timeout_s': 5.0, 'supply': supply, 'actuators': {
            f'ram_{k}': {'model': 'isa_v5', 'load': {'kind': 'mass', 'inertia': 50.0},
                         'initial_position_mm': 50.0} for k in range(N)}}
    tracks: Tree = {}
    for k in range(N):
        amplitude, frequency, start = MOTIONS[motion](k)
        tracks[f'ram_{k}'] = [{'t_s': 0.0, 'position': 'hold'}]
        if amplitude:
            tracks[f'ram_{k}'].append({'t_s': start, 'position': 'hold', 'sine': {
                'amplitude': 1e-3 * amplitude, 'frequency_hz': frequency}})
    return run, {'name': 'sines', 'duration_s': DURATION_S, 'tracks': tracks}


def simulated(own: Run) -> np.ndarray:
    """Return the pressure of the supply at the end of each tick, Pa."""
    simulation, found = own.simulation(), []
    for _ in range(_ticks(own)):
        simulation.step()
        found.append(float(simulation.supply_samples['supply'].pressure))
    return np.array(found)


def reference(own: Run) -> np.ndarray:
    """Return the same of one ODE."""
    simulation = own.simulation()
    run = simulation.scenario.run
    memory = memory_of(N)
    for k, (config, start) in enumerate(zip(run.actuators, simulation.surroundings.starts())):
        SmartActuator(config, timing_of(run), row_of(memory, k)).start(*start.item())
    commands = np.zeros((_ticks(own), N), COMMAND)
    for tick, rows in enumerate(commands):
        simulation.scenario.commands(tick, rows)
    sheet = run.supplies[0].sheet
    return pressures(commands, run.step_ns // PLANT_STEP_NS, sheet.pressure_mpa * MPA,
                     supply_record(sheet), memory)


def _ticks(own: Run) -> int:
    return round(DURATION_S * 1e3)


def difference(volume_ml: float, port: str, motion: str) -> PressureDifference:
    """Return what a run's pressure differs by from that of one ODE."""
    own = load(*tree_of(volume_ml, port, motion))
    exact = reference(own)
    off = simulated(own) - exact
    return PressureDifference(float(np.sqrt(np.mean(off * off))), float(abs(off).max()),
                              float(exact.min()), float(exact.max()))


def row(motion: str, volume_ml: float, own: PressureDifference) -> str:
    """Return a row of the table of the page."""
    return (f'| {motion} | {volume_ml:g} ml | {own.least / MPA:.1f} to {own.most / MPA:.1f} MPa '
            f'| {own.rms / MPA:.3f}, {own.greatest / MPA:.2f} MPa |')


def table() -> str:
    """Return the table of the page."""
    lines = ['| motion | oil in the manifold | pressure of one ODE | moving port: rms, greatest |',
             '|---|---|---|---|']
    for motion in MOTIONS:
        for volume in VOLUMES_ML:
            lines.append(row(motion, volume, difference(volume, 'moving', motion)))
            print(lines[-1], flush=True)
    return '\n'.join(lines)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--write', action='store_true', help='into docs/parts.md')
    options = parser.parse_args()
    text = table()
    if options.write:
        PAGE.write_text(with_parts(PAGE.read_text(), {'supply port': text.splitlines()}))
