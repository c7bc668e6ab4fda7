"""
Oil below the pressure of the atmosphere, in simulation: what it releases, boiling, cavities.

The load of a shipped actuator is moved out and back while its lands and seals are shut, as in a
cylinder with plugged ports; chamber A is torn open and closes. What the oil of a sealed chamber
does follows from its mass alone: p + beta ln V is constant above the atmosphere, below it the
oil expands by the integral of dp/beta of C5, and what it leaves free at its vapour pressure is
the cavity. Then the load is held outside, and the refill valve (C6) fills the cavity.
"""

from dataclasses import replace
import math
from typing import NamedTuple

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.analysis.response.actuator_trace import RATE_HZ
from isa_ros.config.runs.changed_parameters import with_parameters
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.plant.rest_oil import rest_pressures
from isa_ros.validation.actuators import CheckedActuators, SHIPPED
from isa_ros.validation.behaviour import bench, MODELS, SHUT
from isa_ros.validation.entry import around, Entry, Findings, OWN
from isa_ros.validation.sheets import model_sheet, plant_of
import numpy as np

PLACE, TRAVEL = 0.3, 0.12       # of the stroke
SLOW_S, FAST_S = 0.1, 0.006     # a stroke; the fast one leaves a cavity in spite of the refill
HELD_S = 0.005
RELEASED = -40e3, -80e3         # Pa
REFILL_DROP = 1e5               # Pa, at which a sheet states its refill
SEALED = {**SHUT, 'plant.relief.refill_lpm': 1e-9}
KPA = 1e3


class Torn(NamedTuple):
    """Chamber A over time, (n,) each."""

    volume: np.ndarray
    """By the place of the piston, of the shipped dimensions, m3."""
    pressure: np.ndarray
    """Pa."""
    cavity: np.ndarray
    """m3."""


def cavities(actuators: CheckedActuators = SHIPPED) -> Findings:
    """Tear the chambers of the simulated plants open, and close them."""
    return Findings(tuple(entry for model in MODELS for entry in (
        *_sealed(actuators, model), _refilled(actuators, model))))


def moved(
        actuators: CheckedActuators, model: str, shut: dict[str, float],
        *strokes: float) -> Torn:
    """
    Return chamber A of an actuator whose load moves ``strokes``, s each: out, back, ...

    Each with a constant acceleration and deceleration from rest to rest; 0 s is `HELD_S` at rest.
    """
    found = bench(actuators, model, 'mass', PLACE)
    found = found.with_config(with_parameters(
        replace(found.config, load=None), shut, found.run.source))
    oil = plant_of(model).chambers
    travel, rows = TRAVEL * float(oil.stroke), []
    group, ports = found.begin(force=0.0), found.ports
    ports['x0'] = found.config.initial_position
    for k, seconds in enumerate(strokes):
        n = round((seconds or HELD_S) * RATE_HZ / 2.0)
        pace = 0.0 if seconds == 0.0 else (-1.0) ** k * 4.0 * travel / (seconds * seconds)
        for a_bias in (pace, -pace):
            for _ in range(n):
                ports['a_bias'] = a_bias
                reply, sample = group.advance(ports)[0], group.samples[0]
                ports['x0'] += (ports['v0'] + 0.5 * a_bias / RATE_HZ) / RATE_HZ
                ports['v0'] += a_bias / RATE_HZ
                rows.append((reply['position'], sample['chamber_pressure_a'], sample['cavity_a']))
    place, pressure, cavity = np.array(rows).T
    return Torn(oil.dead_volume + oil.area_a * place, pressure, cavity)


def _sealed(actuators: CheckedActuators, model: str) -> tuple[Entry, ...]:
    """Compare a slow stroke out and back with the mass of the oil."""
    oil = plant_of(model).chambers
    beta, p_air, p_vapour = float(oil.beta), float(oil.p_air), float(oil.p_vapour)
    start, _ = rest_pressures(plant_of(model), PAPER_SUPPLY, 0.0, 0.0)

    def strain(p: float) -> float:
        """Return the integral of dp/beta from ``p`` below the atmosphere to it  (C5)."""
        return -p * (1.0 - 0.5 * p / p_air) / beta
    volume, pressure, cavity = moved(actuators, model, SEALED, SLOW_S, SLOW_S)
    first, widest = volume[0], int(np.argmax(cavity))
    falling = slice(int(np.argmax(pressure < 0.0)), widest)
    high, low = np.interp(-np.array(RELEASED), -pressure[falling], np.log(volume[falling]))
    back = pressure[-1] + beta * math.log(volume[-1] / first)
    return (
        _entry(f'{model}_released_air', (low - high) / MILLI,
               (strain(RELEASED[1]) - strain(RELEASED[0])) / MILLI, 'per mille',
               'C5: the oil expands from {:g} to {:g} kPa'.format(*np.array(RELEASED) / KPA), 2.0),
        _entry(f'{model}_cavity_pressure', float(pressure.min()) / KPA, p_vapour / KPA, 'kPa',
               'the vapour pressure', 0.1),
        _entry(f'{model}_oil_beside_a_cavity', 1e2 * (volume[widest] - cavity[widest]) / first,
               1e2 * math.exp(start / beta + strain(p_vapour)), 'percent',
               'the mass of the oil (C11), of its volume before', 0.1),
        _entry(f'{model}_closed_cavity', back / MPA, start / MPA, 'MPa',
               'that before the stroke out and back, for the volume of then', 0.1))


def _refilled(actuators: CheckedActuators, model: str) -> Entry:
    """Compare how fast the oil beside a cavity grows that is held open."""
    volume, _, cavity = moved(actuators, model, SHUT, FAST_S, 0.0)
    held = np.arange(len(cavity)) >= round(FAST_S * RATE_HZ)
    own = np.flatnonzero(held & (cavity > 0.0))
    filled = volume - cavity
    ours = float('nan') if len(own) < 2 else (
        (filled[own[-1]] - filled[own[0]]) / (own[-1] - own[0]) * RATE_HZ)
    oil, sheet = plant_of(model).chambers, model_sheet(model).plant.relief
    drop = -float(oil.p_vapour) / REFILL_DROP
    return _entry(f'{model}_refill', float(ours) / LPM, sheet.refill_lpm * drop * drop, 'l/min',
                  'C6 at the vapour pressure', 2.0)


def _entry(
        name: str, ours: float, expected: float, unit: str, law: str, percent: float) -> Entry:
    return Entry(
        name=name, source=OWN, where='section 2.7', paper='no such number', ours=float(ours),
        unit=unit, tolerance=around(expected, percent=percent),
        tolerance_source=f'{expected:.4g} by {law}; {percent:g} %')
