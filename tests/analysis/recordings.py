"""Recordings of moving actuators for the tests of identification."""

from dataclasses import replace
from functools import lru_cache

from isa_ros.analysis.signals.recording import Recording
from isa_ros.core.signals import SAMPLE
import numpy as np
from tests.sheets import actuator_sheet, override, plant_row, setpoint, smart_actuator, TICK

SUPPLY = 20.7e6

# Stiffness, damping; then seconds, centre from mid stroke, amplitude and frequency of sines:
# through null and beyond the dual-gain point, against both rig stops, slowly.
MOTIONS = {
    'smart_manifold': (1000.0, 40.0, [
        (2.0, 0.0, 0.4, 1.0), (2.0, 0.0, 0.3, 1.7), (1.0, 0.0, 0.84, 0.25),
        (2.0, 0.84, 0.04, 2.1), (1.0, 0.84, -0.84, 0.25), (1.0, 0.0, -0.84, 0.25),
        (2.0, -0.84, 0.04, 2.1), (1.0, -0.84, 0.84, 0.25), (5.0, 0.0, 0.05, 0.2)]),
    'isa_v5': (1.0e5, 4000.0, [
        (2.0, 0.0, 0.02, 1.5), (2.0, 0.0, 0.015, 2.3), (1.0, 0.0, 0.06, 0.25),
        (2.0, 0.06, 0.01, 2.1), (1.0, 0.06, -0.06, 0.25), (1.0, 0.0, -0.06, 0.25),
        (2.0, -0.06, 0.01, 2.1), (1.0, -0.06, 0.06, 0.25), (5.0, 0.0, 0.006, 0.4)]),
    'isa_v2': (1.0e5, 4000.0, [
        (2.0, 0.0, 0.02, 1.5), (2.0, 0.0, 0.028, 4.2), (1.0, 0.0, 0.042, 0.25),
        (2.0, 0.042, 0.004, 2.1), (1.0, 0.042, -0.042, 0.25), (1.0, 0.0, -0.042, 0.25),
        (2.0, -0.042, 0.004, 2.1), (1.0, -0.042, 0.042, 0.25)]),
}
ANOTHER = {
    'valve.low_gain_lpm_per_ma': 0.5, 'valve.high_gain_lpm_per_ma': 2.1,
    'valve.dual_gain_point_mm': 0.038, 'valve.null_leakage_lpm': 0.05,
    'oil.effective_bulk_modulus': 5.5e8,
}
CHANGED = {
    'smart_manifold': ANOTHER | {
        'oil.cross_port_leakage': 3.0e-13, 'friction.coulomb': 2.6, 'friction.stiction': 3.2,
        'friction.viscous': 0.5},
    'isa_v5': ANOTHER | {
        'oil.cross_port_leakage': 4.0e-14, 'friction.coulomb': 130.0, 'friction.stiction': 160.0,
        'friction.viscous': 320.0},
    'isa_v2': {},
}
"""Parameters of the plant that is recorded, by their paths below `plant`; unknown to the fit."""


@lru_cache
def samples(model: str) -> np.ndarray:
    """Return the `SAMPLE` rows of the changed actuator against rig stops, 1 ms apart."""
    sheet = actuator_sheet(model)
    for path, value in CHANGED[model].items():
        sheet = override(sheet, f'plant.{path}', value)
    stiffness, damping, sines = MOTIONS[model]
    actuator = smart_actuator(model, 'wheel', sheet=sheet, timing=TICK)
    middle = 0.5 * sheet.plant.drive.stroke
    rows = [actuator.sample.copy()]
    for duration, centre, amplitude, frequency in sines:
        for k in range(round(1e3 * duration)):
            phase = 2.0 * np.pi * frequency * 1e-3 * k
            actuator.accept(setpoint(
                position=middle + centre + amplitude * np.sin(phase),
                velocity=2.0 * np.pi * frequency * amplitude * np.cos(phase),
                stiffness=stiffness, damping=damping))
            actuator.tick()
            rows.append(actuator.sample.copy())
    return np.array(rows, SAMPLE)


def recording(model: str) -> Recording:
    """Return the sensor signals, with the shipped sheet as known parameters."""
    rows = samples(model)
    return Recording(
        plant=plant_row(model), step=1e-3, supply_pressure=np.full(len(rows), SUPPLY),
        return_pressure=0.0, **{
            name: rows[name].copy() for name in (
                'position', 'force', 'pressure_a', 'pressure_b', 'spool')})


def noisy(clean: Recording, seed: int) -> Recording:
    """Return the recording with white noise on top of the converters' steps."""
    random = np.random.default_rng(seed)
    deviations = {'position': 1.0, 'force': 1.0, 'pressure_a': 1.5, 'pressure_b': 1.5,
                  'spool': 1.5}  # in the sensor's own steps
    return replace(clean, **{
        name: getattr(clean, name) + random.normal(
            0.0, deviation * clean.resolution(name), len(clean.position))
        for name, deviation in deviations.items()})
