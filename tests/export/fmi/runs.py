"""Runs beside units: the same actuator in a simulation, tick by tick."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import isa_ros
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import parse, read
from isa_ros.core.objects import own_target
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_QUICK_STOP, HAS_REFERENCE,
    HAS_SETPOINT, SAMPLE_FIELDS)
from isa_ros.export.chosen import ChosenActuator
from isa_ros.export.fmi.description import Version
from isa_ros.export.fmi.inputs import PORT_FIELDS
from isa_ros.export.fmi.unit import archive, made, parts_of, UnitContent
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
import numpy as np
from tests.kernels import make_exported

MOTIONS = parse("""
name: motions
duration_s: 0.3
tracks:
  ram:
  - {t_s: 0.0, position: hold, stiffness: 2.0e+5, damping: 4000.0}
  - {t_s: 0.05, position: 0.06}
  - {t_s: 0.1, position: 0.055, sine: {amplitude: 0.004, frequency_hz: 8.0, moves: position}}
  - {t_s: 0.2, position: 0.05, effort: 300.0}
""", 'motions')
ACCUMULATOR = {
    'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.3, 'gas_volume_l': 0.3,
    'precharge_mpa': 12.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.2,
    'bulk_modulus': 7e8, 'pump_flow_lpm': 10.0, 'pump_lag_s': 0.05, 'pump_band_mpa': 0.5,
    'relief_mpa': 21.5, 'relief_lpm_per_mpa': 20.0,
    'return_line': {'kind': 'volume', 'oil_volume_l': 0.3, 'bulk_modulus': 7e8,
                    'tank_lpm_per_mpa': 40.0}}
MOVING = {
    'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.1, 'gas_volume_l': 0.2,
    'precharge_mpa': 12.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.05,
    'bulk_modulus': 1e9, 'pump_flow_lpm': 12.0, 'pump_lag_s': 0.03, 'pump_band_mpa': 0.5,
    'relief_mpa': 22.5, 'relief_lpm_per_mpa': 10.0, 'port': {'kind': 'moving'}}
LINK = {'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 1, 'jitter_us': 100.0, 'loss': 0.1}
OF_EACH = {'haa': {'kind': 'constant', 'pressure_mpa': 19.0, 'return_pressure_mpa': 0.0},
           'hfe': ACCUMULATOR, 'kfe': MOVING}

LEG = {key: value for key, value in read(find('leg', CONFIG)).items() if key != 'supply'} | {
    'supplies': {f'of_{name}': {**own, 'feeds': [name]} for name, own in OF_EACH.items()}}
"""The leg with a supply for each actuator."""
RUNS: Mapping[str, tuple[str, Any, str, Mapping[str, Any]]] = {
    'own_load': ('rig_linear', MOTIONS, 'ram', {}),
    'accumulator': ('rig_linear', MOTIONS, 'ram', {'supply': ACCUMULATOR}),
    'moving': ('rig_linear', MOTIONS, 'ram', {'supply': MOVING}),
    'at_once': ('rig_linear', MOTIONS, 'ram', {'controller_offset_ms': 0.0}),
    'link': ('rig_linear', MOTIONS, 'ram', {'link': LINK}),
    'rotary': ('rig_rotary', 'step', 'rotor', {}),
    'port': (LEG, 'drop', 'kfe', {})}
"""Configuration, scenario, actuator and changes."""


class Tick(NamedTuple):
    """What an actuator gets in a tick, and what it and its supply have at the end, as copies."""

    port: np.void
    command: np.void
    sample: np.void
    reply: np.void
    supply: np.void


class Case(NamedTuple):
    """A run, an actuator in it, and the unit of this with its supply."""

    run: isa_ros.Run
    chosen: ChosenActuator
    made: UnitContent
    first: tuple[np.void, np.void]
    """`SAMPLE` and `SUPPLY_SAMPLE` at t = 0."""
    ticks: Sequence[Tick]
    paths: Mapping[Version, Path]


def case_of(name: str, directory: Path) -> Case:
    """Return one of `RUNS`, its units written to a directory."""
    config, scenario, actuator, changes = RUNS[name]
    run = isa_ros.load(config, scenario, changes=changes, duration=0.3)
    simulation = run.simulation()
    row = simulation.names.index(actuator)
    at = next(k for k, own in enumerate(run.configuration.supplies) if actuator in own.feeds)
    supplies = simulation.surroundings.supplies
    first = simulation.group.observed[row].copy(), supplies[at].copy()
    ticks = []
    for _ in range(simulation.scenario.n_ticks or 0):
        simulation.step()
        rows = simulation.loop.rows
        ticks.append(Tick(*(own[row].copy() for own in (
            rows.ports, rows.commands, rows.samples, rows.replies)), supplies[at].copy()))
    chosen = ChosenActuator(run.configuration, {}, row, {})
    parts = parts_of(chosen)
    make_exported(parts.own, own_target())
    own = made(parts, own_target())
    paths = {version: directory / f'unit{version.value[0]}.fmu' for version in Version}
    for version, path in paths.items():
        path.write_bytes(archive(own, version))
    return Case(run, chosen, own, first, ticks, paths)


def inputs_of(tick: Tick, has_port: bool) -> Iterator[tuple[str, Any]]:
    """Yield the inputs of a unit for a tick."""
    command = tick.command
    kinds = int(command['kinds'])
    if has_port:
        for field, (name, _, _) in PORT_FIELDS.items():
            yield f'port.{name}', float(tick.port[field])
    if kinds & HAS_SETPOINT:
        for name in ('position', 'velocity', 'effort'):
            yield f'setpoint.{name}', float(command[name])
    if kinds & (HAS_SETPOINT | HAS_GAINS):
        for name in ('stiffness', 'damping'):
            if not np.isnan(command[name]):
                yield f'setpoint.{name}', float(command[name])
    if kinds & HAS_ENABLE:
        yield 'enable', bool(command['is_enabled'])
    if kinds & HAS_MODE:
        yield 'mode', int(command['mode'])
    if kinds & HAS_REFERENCE:
        yield 'reference', float(command['reference'])
    yield 'clear_fault', bool(kinds & HAS_CLEAR_FAULT)
    yield 'quick_stop', bool(kinds & HAS_QUICK_STOP)


SAMPLED = {field.name: field.name for field in SAMPLE_FIELDS}
OF_SUPPLY = {f'supply.{field.name}': field.name for field in SUPPLY_FIELDS}
