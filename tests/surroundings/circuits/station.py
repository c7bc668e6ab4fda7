"""A circuit with every kind of part, driven by flows and stiffnesses that change."""

from isa_ros.surroundings.circuits.circuit import Circuit
import numpy as np
from tests.surroundings.circuits.advanced import advance

STATION = """
tank: {kind: tank, pressure_mpa: 0.2}
pump: {kind: pump, inlet: tank, outlet: gallery, pressure_mpa: 20.0, displacement_ml: 20.0,
       speed_rpm: 1500.0, power_w: 6000.0, leakage_lpm_per_mpa: 0.05}
gallery: {kind: manifold, oil_volume_l: 0.5}
safety: {kind: relief, inlet: gallery, outlet: tank, opens_mpa: 22.0, lpm_per_mpa: 30.0}
spared: {kind: unloading, inlet: gallery, outlet: tank, senses: stored, opens_mpa: 19.5,
         shuts_mpa: 18.0, rated_lpm: 60.0}
kept: {kind: check, inlet: gallery, outlet: stored, rated_lpm: 60.0}
stored: {kind: manifold, oil_volume_l: 0.5}
buffer: {kind: accumulator, at: stored, gas_volume_l: 0.5, precharge_mpa: 12.0,
         thermal_time_constant_s: 0.5}
dumped: {kind: dump, inlet: stored, outlet: tank, rated_lpm: 30.0}
hose: {kind: line, inlet: stored, outlet: left, length_m: 2.0, bore_mm: 12.0,
       wall: {kind: hose, expansion: 0.02, expansion_mpa: 10.0}}
left: {kind: manifold, oil_volume_l: 0.3, returns_to: drain}
shut: {kind: block, inlet: stored, outlet: right, rated_lpm: 30.0, time_constant_ms: 2.0}
right: {kind: manifold, oil_volume_l: 0.5, returns_to: drain}
drain: {kind: manifold, oil_volume_l: 1.0}
strainer: {kind: filter, inlet: drain, outlet: tank, lpm_per_mpa: 200.0}
"""
LPM = 1e-3 / 60.0


def driven(circuit: Circuit, ticks: int, rng: np.random.Generator) -> float:
    """Advance with random flows; return the oil that went through, m3."""
    through = 0.0
    for _ in range(ticks):
        drawn = rng.uniform(-2.0, 8.0, 2) * LPM * 1e-3
        returned = drawn * rng.uniform(0.3, 0.9, 2)
        advance(circuit, drawn.tolist(), returned.tolist())
        through += float(abs(drawn).sum() + abs(returned).sum())
    return through


def surplus(circuit: Circuit) -> float:
    """Return by how much the account of the whole does not close, J."""
    whole = circuit.samples[0]
    return float(whole['pump_energy'] + whole['held_energy'] - whole['energy']
                 - whole['relief_energy'] - whole['return_energy'] - whole['stored_energy'])
