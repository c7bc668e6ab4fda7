"""The ratings that an actuator's protection compares with, from its own data sheet."""

import math

from isa_ros.core.oil_properties import thickness
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import MICRO, MILLI
from isa_ros.plant.hose import largest_resistance
from isa_ros.plant.hysteresis import widest_play
from isa_ros.plant.servo_valve import flow_curve
from isa_ros.plant.spool import CLOSED_LOOP, PILOTED
from isa_ros.plant.thermal import coldest
from isa_ros.reu.block import Pid
from isa_ros.reu.lead_lag import LeadLag
from isa_ros.reu.plausibility import EVIDENCE, VALVE_EVIDENCE
from isa_ros.reu.protection import Ratings
from isa_ros.reu.supervision import SUPERVISION
from isa_ros.reu.wiring import loop_steps, Off, Reu
import numpy as np

_CERTAIN = 0.2  # of the spool's stop: open whatever the null bias
_CREEP = 0.02   # of the speed at full opening: slower is no motion towards a reference
_SLOW = 0.0064  # s, 25 Hz: what is slower is no oscillation of a loop
_ANY = 1e12     # N | Nm: more than any force
_MEAN = 0.05    # s: some periods of such an oscillation


def ratings_of(plant: np.record) -> Ratings:
    """Return the ratings of a `PLANT` record."""
    oil, valve, sensors = plant.chambers, plant.valve, plant.sensors
    flow = flow_curve(valve.x_max, valve) * valve.per_root_drop * math.sqrt(_rated_drop(plant))
    least = oil.area_a if plant.spring.is_on else min(oil.area_a, oil.area_b)
    return Ratings(
        stroke=math.inf if is_endless(plant) else float(oil.stroke), speed=float(flow / least),
        force_range=float(sensors.force_range), pressure_range=float(sensors.pressure_range),
        current_range=float(sensors.current_range),
        opening_pressure=float(plant.relief.p_open), spool_stop=float(valve.x_max))


def _rated_drop(plant: np.record) -> float:
    """
    Return the drop over an open land at the rated speed, in Pa.

    Twice the part of the relief valves' opening pressure that the valve has over each land: half
    of it over the two of a double-acting piston, all of it over the one of a single-acting
    cylinder. A compensator bounds the drop from the supply, so not that of oil which a
    single-acting cylinder gives to the tank.
    """
    opening, compensated = float(plant.relief.p_open), float(plant.valve.most_drop)
    if plant.spring.is_on:
        return 2.0 * opening
    return min(opening, compensated) if compensated > 0.0 else opening


def is_endless(plant: np.record) -> bool:
    """Return whether a `PLANT` record is that of a motor."""
    return not plant.chambers.swept_a


def own_ends(plant: np.record) -> tuple[float, float]:
    """Return the lengths at both ends in which an end takes a force, m; -inf: no end."""
    if is_endless(plant):
        return -math.inf, -math.inf
    return float(plant.cushion_a.length), float(plant.cushion_b.length)


def forcing_areas(plant: np.record) -> tuple[float, float]:
    """
    Return the areas that give the largest forces out and in with a pressure, m2 | m3/rad.

    Those of the piston; of a single-acting cylinder A less the area that holds the extended spring
    at the relief valves' opening pressure, and the area that has its mean force there.
    """
    oil, spring = plant.chambers, plant.spring
    if not spring.is_on:
        return float(oil.area_a), float(oil.area_b)
    most = spring.preload + spring.stiffness * oil.stroke
    pressure = plant.relief.p_open
    return (max(0.0, float(oil.area_a - most / pressure)),
            float(0.5 * (spring.preload + most) / pressure))


def null_speed(plant: np.record) -> float:
    """
    Return the speed that the flow curve's slope about null gives over the spool's whole travel.

    Half of the relief valves' opening pressure is over one land.
    """
    valve, oil = plant.valve, plant.chambers
    flow = flow_curve(_NEAR_NULL * valve.x_max, valve) / _NEAR_NULL * valve.per_root_drop
    return float(flow * math.sqrt(0.5 * plant.relief.p_open) / max(oil.area_a, oil.area_b))


_NEAR_NULL = 0.01  # of the travel: on the first line of every flow curve


def valve_lag(plant: np.record, reu: Reu) -> float:
    """Return the lag from a conversion to the spool: sampling, delay, current and spool, in s."""
    steps = loop_steps(reu)
    sampling = steps['current'] + (0 if isinstance(reu.spool, Off) else steps['spool'])
    return (sampling * PLANT_STEP + reu.computation_delay_us * MICRO
            + _current_lag(plant.coil, reu) + _spool_lag(plant, reu))


def evidence_of(
        plant: np.record, reu: Reu, has_spool_sensor: bool, offset_steps: int) -> np.record:
    """
    Return the `EVIDENCE` record of a `PLANT` record and its REU.

    The sensors read hoses: their drop is like friction, with seals and oil of a thermal actuator
    at its coldest, and behind a load-holding valve they say nothing about the force.
    """
    steps, oil, ends = loop_steps(reu), plant.chambers, own_ends(plant)
    stiction, viscous = plant.friction.stiction, plant.friction.sigma2
    if plant.holding_a.kind or plant.holding_b.kind:
        stiction = _ANY
    elif plant.hoses.is_on:
        flow = ratings_of(plant).speed * max(oil.area_a, oil.area_b)
        thicker = _thickest(plant.thermal)
        viscous = thicker * viscous + (
            oil.area_a * oil.area_a + oil.area_b * oil.area_b) * largest_resistance(
                plant.hoses, flow, thicker)
    return record(
        EVIDENCE, area_a=plant.chambers.area_a, area_b=plant.chambers.area_b,
        end_a=ends[0], end_b=ends[1],
        preload=plant.spring.preload, stiffness=plant.spring.stiffness,
        force_range=plant.sensors.force_range, stiction=stiction, viscous=viscous,
        inertia=plant.mechanics.inertia,
        speed_rate=reu.speed.rate_hz, speed_steps=steps['speed'], offset_steps=offset_steps,
        valve=_valve_evidence(plant, reu, has_spool_sensor, steps['current'] * PLANT_STEP))


def _thickest(thermal: np.record) -> float:
    """Return the largest viscosity of the oil over that of the sheet, at least 1  (T1)."""
    return max(1.0, float(thickness(coldest(thermal), thermal.oil))) if thermal.is_on else 1.0


def supervision_of(
        plant: np.record, reu: Reu, has_spool_sensor: bool, is_motor: bool) -> np.record:
    """Return the `SUPERVISION` record of a `PLANT` record, of a motor or not, and its REU."""
    oil, valve, sensors = plant.chambers, plant.valve, plant.sensors
    (area_a, area_b), ends = forcing_areas(plant), own_ends(plant)
    period = loop_steps(reu)['current'] * PLANT_STEP
    speed = ratings_of(plant).speed
    return record(
        SUPERVISION, area_a=area_a, area_b=area_b, stroke=oil.stroke,
        end_a=ends[0], end_b=ends[1],
        flow_gain=flow_curve(valve.x_max, valve) * valve.per_root_drop,
        coulomb=plant.friction.coulomb if is_motor else 0.0,
        viscous=plant.friction.sigma2 if is_motor else 0.0,
        force_range=sensors.force_range, pressure_range=sensors.pressure_range,
        current_range=sensors.current_range,
        spool_range=sensors.spool_range if has_spool_sensor else 0.0,
        spool_gain=valve.k_spool / plant.coil.parallel, opening=_CERTAIN * valve.x_max,
        has_two=int(not plant.spring.is_on),
        follows_force=int(not isinstance(reu.force, Off)), creep=_CREEP * speed,
        slow_share=period / (_SLOW + period), mean_share=period / (_MEAN + period))


def _valve_evidence(
        plant: np.record, reu: Reu, has_sensor: bool, period: float) -> np.record:
    """
    Return the `VALVE_EVIDENCE` of a valve whose spool is read every ``period`` seconds.

    A piloted spool follows the reference of its loop in the REU, and is not watched if that loop
    has no K_p; any other follows the current.
    """
    own, lag = plant.spool, _current_lag(plant.coil, reu)
    if own.kind == PILOTED:
        is_closed, gain = isinstance(reu.spool, Pid) and reu.spool.kp > 0.0, 1.0
    else:
        is_closed, gain = True, plant.valve.k_spool / plant.coil.parallel
    spool_lag = _spool_lag(plant, reu)
    return record(
        VALVE_EVIDENCE, is_watched=int(has_sensor and is_closed),
        is_piloted=int(own.kind == PILOTED), gain=gain, stop=plant.valve.x_max,
        play=widest_play(plant.hysteresis) * plant.valve.k_spool,
        share=period / (lag + spool_lag + period))


def _spool_lag(plant: np.record, reu: Reu) -> float:
    """Return the lag of the closed spool loop in s; 0 for a piloted spool without a K_p."""
    own = plant.spool
    if own.kind == PILOTED:
        k_p = reu.spool.kp if isinstance(reu.spool, Pid) else 0.0
        return float(1.0 / (own.k_pilot * k_p)) if k_p > 0.0 else 0.0
    return float(1.0 / own.k_loop if own.kind == CLOSED_LOOP else 2.0 * own.zeta / own.w_n)


def _current_lag(coil: np.record, reu: Reu) -> float:
    """Return the lag of the closed current loop, 1/p_c of V1 or L/(R + K_p) of V11, in s."""
    if isinstance(reu.current, LeadLag):
        return float(coil.inductance / (coil.resistance + reu.current.kp_v_per_ma / MILLI))
    return float(1.0 / coil.p_c)
