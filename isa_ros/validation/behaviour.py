"""
Behaviour of the plant alone, in simulation: friction, oil, valve, and their time constants.

The valve is driven directly: no control block hides the plant. Each result is compared with the
steady or linear solution for the shipped parameters (`plant_theory`), in two-sided bars, so that
another parameter in the simulated actuator shows: `isa validate --sensitivity` relies on it.
"""

from dataclasses import replace

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.analysis.response.actuator_trace import RATE_HZ, TIMING, Trace
from isa_ros.analysis.response.bode import bode
from isa_ros.analysis.response.rig import Choice, Rig
from isa_ros.analysis.response.sweep import FrequencySweep
from isa_ros.config.runs.changed_parameters import with_parameters
from isa_ros.core.units import LPM, MILLI
from isa_ros.loads.sheets import Blocked, Mass, static_force
from isa_ros.plant.rest_oil import rest_pressures
from isa_ros.validation.actuators import CheckedActuators, SHIPPED
from isa_ros.validation.entry import around, Entry, Findings, OWN
from isa_ros.validation.plant_theory import (
    blocked_rise, free_frequency, friction, holding_force, presliding, presliding_decay, steady)
from isa_ros.validation.sheets import plant_of
from isa_ros.validation.torque_step import crossing, quarter_turn
from isa_ros.validation.valve_dynamics import spool_over_reference
import numpy as np

ROTARY = 'smart_manifold'
MODELS = (ROTARY, 'isa_v5')
NEAR_END = 0.1          # of the stroke: dead volume and swept volume are of one order
PRELOAD = 0.3           # of the hydraulic stall force, released
RING_S = 0.4
TINY = 1e-3             # of the Coulomb friction: a ring in which the bristles do not slip
CYCLES = 3
STUCK = 0.3             # of the Coulomb friction
SLIDING = 2.0           # times the stiction
CREEP_S = 1.0
LEAKED_S = 3.0          # several times what the trapped oil takes to leak
SLOW, FAST = 0.5, 2.0   # times the Stribeck speed
HELD_MA = 0.03          # coils in series: within the leakage of the lands
RISE_MA = 0.3
RISE = (0.1, 0.3)       # of the hydraulic stall force
RISE_S = 0.3
SWEEP = FrequencySweep(low=20.0, high=300.0, points=16)
SMALL_MM = 0.005        # of spool
SHUT = {'plant.valve.null_leakage_lpm': 0.0, 'plant.oil.cross_port_leakage': 0.0}
PERCENT = 2.0
NOTHING = 'no such number'


def behaviour(actuators: CheckedActuators = SHIPPED) -> Findings:
    """Compare friction, oil and valve of the simulated plants with their equations' solutions."""
    return Findings((_presliding(actuators), *(
        entry for model in MODELS for part in (_friction, _oil, _valve)
        for entry in part(actuators, model))))


def bench(actuators: CheckedActuators, model: str, load: str, place: float = 0.5) -> Rig:
    """Return an actuator at a share of its stroke whose valve is driven directly."""
    found = actuators.rig(Choice(
        name=model, loop='spool', variants=('valve_amplifier',), load=load))
    return found.with_config(replace(
        found.config, initial_position=place * float(plant_of(model).chambers.stroke)))


def pushed(found: Rig, force: float) -> Rig:
    """Return a bench with a free mass, a force on it (N | Nm)."""
    return found.with_config(with_parameters(
        found.config, {'load.force': force}, found.run.source))


def light(found: Rig, model: str) -> Rig:
    """Return a bench with a mass as light as the shipped piston or rotor."""
    piston = float(plant_of(model).mechanics.inertia)
    return found.with_config(with_parameters(
        found.config, {'load.inertia': piston}, found.run.source))


def driven(found: Rig, spool: float, seconds: float) -> Trace:
    """Return the trace from rest on with the spool's reference at a position (m)."""
    return found.excite(found.begin(force=0.0), np.full(round(seconds * RATE_HZ), spool))


def stall(model: str) -> float:
    """Return the hydraulic force of the supply on the piston, extending, N or Nm."""
    return float(plant_of(model).chambers.area_a) * PAPER_SUPPLY


def spool_at(model: str, current: float) -> float:
    """Return the spool position (m) at a current (mA), coils in series."""
    return float(current * MILLI * plant_of(model).valve.k_spool)


def _entry(
        name: str, where: str, ours: float, expected: float, unit: str, law: str,
        percent: float = PERCENT) -> Entry:
    return Entry(
        name=name, source=OWN, where=where, paper=NOTHING, ours=float(ours), unit=unit,
        tolerance=around(expected, percent=percent),
        tolerance_source=f'{expected:.4g} by {law}; {percent:g} %')


def _friction(actuators: CheckedActuators, model: str) -> list[Entry]:
    own = plant_of(model).friction
    free = bench(actuators, model, 'mass')
    unit, speed_unit = ('Nm', 'rad/s') if model == ROTARY else ('N', 'm/s')
    where = 'section 5.1'
    slid = SLIDING * own.stiction
    creep = driven(pushed(free, slid), 0.0, CREEP_S)['velocity']
    entries = [
        _entry(f'{model}_slip', where, _end(creep),
               steady(model, spool=0.0, force=slid).speed, speed_unit,
               'friction and leakage, twice the stiction at a closed valve', 5.0)]
    for name, times in (('slow', SLOW), ('fast', FAST)):
        speed = times * float(own.v_s)
        trace = driven(free, steady(model, speed=speed).spool, CREEP_S)
        oil = plant_of(model).chambers
        entries.append(_entry(
            f'{model}_friction_{name}', where,
            _end(oil.area_a * trace['pressure_a'] - oil.area_b * trace['pressure_b']),
            friction(model, speed), unit, f'g(v) + sigma_2 v (F1, F3) at {times:g} v_s'))
    return entries


def _presliding(actuators: CheckedActuators) -> Entry:
    """
    Compare the travel under a force below friction, which the oil holds until it has leaked.

    On the rotary actuator, whose friction is printed, and whose valve at null leaves no force.
    """
    stuck = STUCK * plant_of(ROTARY).friction.coulomb
    found = pushed(bench(actuators, ROTARY, 'mass'), float(stuck))
    assert isinstance(found.config.load, Mass)
    place = found.excite(found.begin(static_force(found.config.load)),
                         np.zeros(round(LEAKED_S * RATE_HZ)))['position']
    return _entry(
        f'{ROTARY}_presliding', 'section 5.1', (place[-1] - place[0]) / MILLI,
        presliding(ROTARY, stuck) / MILLI, 'mrad', 'F2 at 0.3 of the Coulomb friction')


def _end(values: np.ndarray) -> float:
    """Return the mean of the last tenth."""
    return float(np.mean(values[-len(values) // 10:]))


def _oil(actuators: CheckedActuators, model: str) -> list[Entry]:
    oil, unit = plant_of(model).chambers, 'Nm' if model == ROTARY else 'N'
    free = bench(actuators, model, 'mass', NEAR_END)
    shipped = bench(SHIPPED, model, 'mass').config.load
    assert isinstance(shipped, Mass)
    piston = float(plant_of(model).mechanics.inertia)
    blocked = bench(actuators, model, 'blocked')
    support = bench(SHIPPED, model, 'blocked').config.load
    assert isinstance(support, Blocked)
    held, rising = spool_at(model, HELD_MA), spool_at(model, RISE_MA)
    trace = driven(blocked, held, LEAKED_S)
    force = driven(blocked, rising, RISE_S)['force']
    t = np.arange(len(force)) / RATE_HZ
    levels = RISE[0] * stall(model), RISE[1] * stall(model)
    low, high = (crossing(t, force, level) for level in levels)
    start = rest_pressures(plant_of(model), PAPER_SUPPLY, 0.0, 0.0)
    return [
        _entry(f'{model}_light_vibration', 'section 4', _frequency(light(free, model), model),
               free_frequency(model, NEAR_END, piston), 'Hz',
               'the same springs under a load as light as piston or rotor', 5.0),
        _entry(f'{model}_free_vibration', 'section 4', _frequency(free, model),
               free_frequency(model, NEAR_END, shipped.inertia), 'Hz',
               'the springs of oil and sensor at 10 % of the stroke', 5.0),
        _entry(f'{model}_presliding_decay', 'section 4', _decay(free, model),
               presliding_decay(model, NEAR_END, shipped.inertia), '1/s',
               'the dampers of bristles, seals and sensor, where nothing slips', 5.0),
        _entry(f'{model}_pressure_gain', 'section 2.2',
               _end(oil.area_a * trace['pressure_a'] - oil.area_b * trace['pressure_b']),
               holding_force(model, held), unit, f'the leaking lands at {HELD_MA:g} mA, blocked'),
        _entry(f'{model}_force_rise', 'eqs 3, 4', (high - low) / MILLI,
               blocked_rise(model, support, 0.5, rising, start, levels) / MILLI, 'ms',
               f'eqs 3 and 4 at {RISE_MA:g} mA, blocked, 10 to 30 % of the stall force', 5.0)]


def _frequency(free: Rig, model: str) -> float:
    """Return the frequency (Hz) of a released preload, the mean of `CYCLES`; NaN if fewer."""
    ring = free.excite(free.begin(force=PRELOAD * stall(model)),
                       np.zeros(round(RING_S * RATE_HZ)))['force']
    up = np.flatnonzero((ring[:-1] < 0.0) & (ring[1:] >= 0.0))
    if len(up) <= CYCLES:
        return float('nan')
    at = up - ring[up] / (ring[up + 1] - ring[up])
    return float(CYCLES * RATE_HZ / (at[CYCLES] - at[0]))


def _decay(free: Rig, model: str) -> float:
    """Return the rate (1/s) at which a tiny ring dies out between shut lands and seals."""
    shut = free.with_config(with_parameters(free.config, SHUT, free.run.source))
    start = float(TINY * plant_of(model).friction.coulomb)
    ring = np.abs(shut.excite(
        shut.begin(force=start), np.zeros(round(RING_S * RATE_HZ)))['force'])
    peaks = 1 + np.flatnonzero((ring[1:-1] > ring[:-2]) & (ring[1:-1] >= ring[2:]))
    return float(-np.polyfit(peaks / RATE_HZ, np.log(ring[peaks]), 1)[0])


def _valve(actuators: CheckedActuators, model: str) -> list[Entry]:
    free = bench(actuators, model, 'mass', 0.2)
    speed_unit = 'rad/s' if model == ROTARY else 'm/s'
    entries = []
    for current, seconds in ((0.8, 0.4), (1.5, 0.25)):
        spool = spool_at(model, current)
        expected = steady(model, spool=spool)
        speed = _end(driven(free, spool, seconds)['velocity'])
        entries.append(_entry(
            f'{model}_speed_{current:g}_ma'.replace('.', '_'), 'Fig 5', speed, expected.speed,
            speed_unit, 'flow curve, areas and friction, without load'))
    response = bode(bench(actuators, model, 'mass'), SWEEP, 'closed', SMALL_MM)
    return [
        *entries,
        _entry(f'{model}_rest_flow', 'Fig 6', supply_flow(bench(actuators, model, 'mass')) / LPM,
               steady(model, speed=0.0).supply_flow / LPM, 'l/min',
               'lands at null and pilot stage'),
        _entry(f'{model}_spool_bandwidth', 'eqs 8, 10', response.bandwidth or float('nan'), 104.0,
               'Hz', 'eqs 8 and 10, -3 dB'),
        _entry(f'{model}_spool_phase', 'eqs 8, 10', quarter_turn(response.response),
               spool_phase_frequency(), 'Hz', 'eqs 8 and 10, -90 deg; held for 0.1 ms')]


def spool_phase_frequency() -> float:
    """
    Return the frequency (Hz) at which eqs 8 and 10 as printed turn by -90 deg.

    With half a period of the reference, which is held for `RATE_HZ`.
    """
    respond = spool_over_reference(ROTARY)
    hz = np.linspace(20.0, 300.0, 2801)
    angle = np.unwrap([np.angle(respond(float(f))) for f in hz])
    return crossing(hz, -np.degrees(angle - np.pi * hz / RATE_HZ), 90.0)


def supply_flow(found: Rig) -> float:
    """Return the flow drawn at rest with a closed valve, m3/s: the mean of the last half."""
    actuator, n = found.begin(force=0.0), 2000
    drawn = [float(actuator.advance(found.ports)['supply_volume'][0]) for _ in range(n)]
    return float(np.mean(drawn[n // 2:])) * 1e9 / TIMING.step_ns
