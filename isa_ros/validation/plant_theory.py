"""
Steady and linear solutions of the shipped plants: what a simulation is compared with.

Chambers without inertia or transients: flows of the lands, cross-port leakage and the motion of
the piston balance (C1, C2), the hydraulic force balances friction and load (M1, F1). Flows are
those of the valve's kernels, compared with figures 5 and 6 elsewhere; the rest is written anew.
"""

import math
from typing import NamedTuple

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.core.units import MPA
from isa_ros.loads.sheets import Blocked
from isa_ros.plant.servo_valve import port_flows
from isa_ros.validation.sheets import plant_of
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root


class Steady(NamedTuple):
    """A motion at constant speed."""

    spool: float
    """m."""
    speed: float
    """m/s or rad/s."""
    p_a: float
    """Pa."""
    p_b: float
    supply_flow: float
    """Drawn from the supply, m3/s."""


def friction(model: str, speed: float) -> float:
    """Return the friction at a constant speed, N or Nm: g(v) sgn v + sigma_2 v  (F1, F3)."""
    own = plant_of(model).friction
    ratio = speed / own.v_s
    level = own.coulomb + (own.stiction - own.coulomb) * math.exp(-ratio * ratio)
    return float(math.copysign(level, speed) + own.sigma2 * speed)


def presliding(model: str, force: float) -> float:
    """
    Return the travel that loads the bristle with a force below stiction, slowly, m or rad.

    dz/dx = 1 - sigma_0 z/F_s  (F2): F = sigma_0 z is reached at -F_s/sigma_0 ln(1 - F/F_s).
    """
    own = plant_of(model).friction
    return float(-own.stiction / own.sigma0 * math.log(1.0 - force / own.stiction))


def steady(
        model: str, *, spool: float | None = None, speed: float | None = None,
        force: float = 0.0) -> Steady:
    """
    Return the motion at a spool position (m), or at a speed, under a force on the load (N | Nm).

    The other one of spool and speed is solved for.
    """
    plant = plant_of(model)
    oil, valve = plant.chambers, plant.valve
    scale = valve.x_dg if spool is None else oil.stroke     # of the unknown

    def unknown(values: np.ndarray) -> tuple[float, float, float, float]:
        p_a, p_b, free = values[0] * MPA, values[1] * MPA, values[2] * scale
        return (p_a, p_b, free, speed) if speed is not None else (p_a, p_b, spool or 0.0, free)

    def balance(values: np.ndarray) -> list[float]:
        p_a, p_b, x, v = unknown(values)
        q_a, q_b, _, _ = port_flows(x, p_a, p_b, PAPER_SUPPLY, 0.0, valve)
        cross = oil.c_li * (p_a - p_b)
        flow = valve.q_0
        return [(q_a - cross - oil.area_a * v) / flow, (q_b + cross + oil.area_b * v) / flow,
                (oil.area_a * p_a - oil.area_b * p_b + force - friction(model, v))
                / (oil.area_a * MPA)]
    direction = math.copysign(1.0, force if spool == 0.0 else speed or spool or 0.0)
    found = root(balance, [0.5 * PAPER_SUPPLY / MPA, 0.5 * PAPER_SUPPLY / MPA, 0.1 * direction],
                 tol=1e-12)
    p_a, p_b, x, v = unknown(found.x)
    drawn = port_flows(x, p_a, p_b, PAPER_SUPPLY, 0.0, valve)[2]
    return Steady(x, v, p_a, p_b, float(drawn))


def holding_force(model: str, spool: float) -> float:
    """Return the hydraulic force of a piston that is held, at a spool position (m), N or Nm."""
    oil, valve = plant_of(model).chambers, plant_of(model).valve

    def imbalance(p_a: float, p_b: float, chamber: int) -> float:
        cross = oil.c_li * (p_a - p_b)
        flow = port_flows(spool, p_a, p_b, PAPER_SUPPLY, 0.0, valve)[chamber]
        return float(flow - cross if chamber == 0 else flow + cross)

    def other(p_a: float) -> float:
        return float(brentq(lambda p_b: imbalance(p_a, p_b, 1), 0.0, PAPER_SUPPLY))
    p_a = brentq(lambda p: imbalance(p, other(p), 0), 0.0, PAPER_SUPPLY)
    return float(oil.area_a * p_a - oil.area_b * other(p_a))


def trapped(model: str, place: float) -> tuple[float, float]:
    """Return beta over the volumes of both chambers at a share of the stroke, Pa/m3  (C1)."""
    oil = plant_of(model).chambers
    return (oil.beta / (oil.dead_volume + oil.area_a * place * oil.stroke),
            oil.beta / (oil.dead_volume + oil.area_b * (1.0 - place) * oil.stroke))


def oil_spring(model: str, place: float) -> float:
    """Return the stiffness of the trapped oil at a share of the stroke, N/m or Nm/rad  (C4)."""
    oil = plant_of(model).chambers
    a, b = trapped(model, place)
    return float(oil.area_a * oil.area_a * a + oil.area_b * oil.area_b * b)


def free_frequency(model: str, place: float, load: float) -> float:
    """
    Return the frequency (Hz) of a free mass (kg | kg m2) on the trapped oil and the sensor.

    Two masses, the piston and the load, on two springs in series, undamped: the lower mode.
    """
    mechanics, spring = plant_of(model).mechanics, oil_spring(model, place)
    stiffness = np.array([[spring + mechanics.k_s, -mechanics.k_s],
                          [-mechanics.k_s, mechanics.k_s]])
    masses = np.array([mechanics.inertia, load])
    return float(math.sqrt(np.linalg.eigvals(stiffness / masses[:, None]).real.min())
                 / (2.0 * math.pi))


def presliding_decay(model: str, place: float, load: float) -> float:
    """
    Return the rate (1/s) at which the lower mode of `free_frequency` dies out in presliding.

    Bristles that do not slip (F2, F3) are one more spring and damper on the piston.
    """
    own, seals = plant_of(model).mechanics, plant_of(model).friction
    spring = oil_spring(model, place) + seals.sigma0
    damping = seals.sigma1 + seals.sigma2
    system = np.array([
        [0.0, 1.0, 0.0, 0.0],
        np.array([-spring - own.k_s, -damping - own.d_s, own.k_s, own.d_s]) / own.inertia,
        [0.0, 0.0, 0.0, 1.0],
        np.array([own.k_s, own.d_s, -own.k_s, -own.d_s]) / load])
    modes = np.linalg.eigvals(system)
    rings = modes[modes.imag > 0.0]
    return float(-rings[np.argmin(np.abs(rings))].real)


def blocked_rise(
        model: str, load: Blocked, place: float, spool: float, start: tuple[float, float],
        forces: tuple[float, float]) -> float:
    """
    Return the time (s) in which the sensor force rises between two ``forces`` at a fixed spool.

    From pressures ``start`` (Pa), without inertia; friction has slipped and is constant.
    """
    plant = plant_of(model)
    oil, valve = plant.chambers, plant.valve
    a, b = trapped(model, place)
    yielding = 1.0 / (1.0 / plant.mechanics.k_s + 1.0 / load.stiffness)
    spring = oil_spring(model, place)

    def rates(_: float, p: np.ndarray) -> list[float]:
        q_a, q_b, _, _ = port_flows(spool, p[0], p[1], PAPER_SUPPLY, 0.0, valve)
        cross = oil.c_li * (p[0] - p[1])
        free = oil.area_a * a * (q_a - cross) - oil.area_b * b * (q_b + cross)
        v = free / (1.0 + spring / yielding) / yielding
        return [a * (q_a - cross - oil.area_a * v), b * (q_b + cross + oil.area_b * v)]

    def reached(force: float) -> float:
        def at(_: float, p: np.ndarray) -> float:
            return float(oil.area_a * p[0] - oil.area_b * p[1]
                         - plant.friction.coulomb - force)
        at.terminal = True      # type: ignore[attr-defined]
        found = solve_ivp(rates, (0.0, 1.0), start, events=at, rtol=1e-8, atol=1.0)
        return float(found.t_events[0][0])
    low, high = forces
    return reached(high) - reached(low)
