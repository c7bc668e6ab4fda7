"""A cylinder with cushions as one system of masses in three volumes  (C30 to C32)."""

import math

from isa_ros.plant.cushion_sheets import SpearCushion
import numpy as np
from scipy.integrate import solve_ivp
from tests.actuator.closed_cylinder import ClosedCylinder

FILLED, OPENS, EASE = 1e6, 3e6, 8e-10      # Pa, Pa, m3/s/Pa: before; relief valves
MASS, SPEED = 400.0, 0.5        # kg, m/s towards the end


class OfMasses:
    """
    The same as one system of equations for position, speed and three masses of oil.

    Masses are over the density at the pressure of the atmosphere. A pressure follows from mass
    and volume; what flows has the density of where it comes from.
    """

    def __init__(self, cylinder: ClosedCylinder, side: str, cushion: SpearCushion) -> None:
        self.oil, self.side = cylinder.plant.chambers, side
        self.cushion = cushion
        bore, spear = 40e-3, cushion.spear_mm * 1e-3
        self.ring = math.pi / 4.0 * (bore * bore - spear * spear)
        self.length = cushion.length_mm * 1e-3

    def pressure(self, mass: float, volume: float) -> float:
        """Return that of C5, down to the vapour pressure."""
        strain = math.log(max(mass / volume, 0.1))     # trial steps go far
        if strain >= 0.0:
            return float(self.oil.beta * strain)
        # p (1 - p/(2 p_air)) = beta strain, of which the root below 0
        p_air = float(self.oil.p_air)
        p = p_air - math.sqrt(p_air * p_air - 2.0 * p_air * float(self.oil.beta) * strain)
        return max(p, float(self.oil.p_vapour))

    def density(self, p: float) -> float:
        """Return it over that at the pressure of the atmosphere."""
        strain = (p if p >= 0.0 else p - 0.5 * p * p / float(self.oil.p_air)) / self.oil.beta
        return math.exp(float(strain))

    def volumes(self, s: float, is_in: bool) -> tuple[float, float, float]:
        """Return those of the port's side, the trapped one and the other chamber."""
        stroke = float(self.oil.stroke)
        d = s if self.side == 'a' else stroke - s
        near, far = float(self.oil.area_a), float(self.oil.area_b)
        if self.side == 'b':
            near, far = far, near
        dead = float(self.oil.dead_volume)
        trapped = self.cushion.trapped_ml * 1e-6 + self.ring * d if is_in else 0.0
        return dead + near * d - trapped, trapped, dead + far * (stroke - d)

    def spear(self, dp: float, d: float) -> float:
        """Return the flow out of the trapped side, m3/s, at the drop over the spear."""
        own, lpm = self.cushion, 1e-3 / 60.0
        root = math.sqrt(own.rated_drop_mpa * 1e6)
        left = max(0.0, 1.0 - (self.length - d) / (own.entry_mm * 1e-3))
        k = (own.restriction_lpm * (1.0 - own.restriction_blocked) + own.port_lpm * left**2)
        flow = k * _smooth_root(dp)
        beyond = -dp - own.check_opening_kpa * 1e3
        if own.check_stuck == 2.0:
            flow += own.check_lpm * _smooth_root(dp)
        elif beyond > 0.0 and own.check_stuck == 0.0:
            flow -= own.check_lpm * _smooth_root(beyond)
        return float(flow * lpm / root)

    def rates(self, _: float, y: np.ndarray, is_in: bool) -> list[float]:
        """Return the rates of s, v and the masses of port's side, trapped side, other chamber."""
        s, v = y[:2]
        volumes = self.volumes(s, is_in)
        d = s if self.side == 'a' else float(self.oil.stroke) - s
        p, p_far = self.pressure(y[2], volumes[0]), self.pressure(y[4], volumes[2])
        p_in, mass = p, 0.0
        if is_in:
            p_in = self.pressure(y[3], volumes[1])
            flow = self.spear(p_in - p, d)
            mass = flow * self.density(p_in if flow > 0.0 else p)
        near, far = float(self.oil.area_a), float(self.oil.area_b)
        if self.side == 'b':
            near, far = far, near
        ring = self.ring if is_in else 0.0
        outwards = (near - ring) * p + ring * p_in - far * p_far
        sign = 1.0 if self.side == 'a' else -1.0
        eased = [EASE * max(0.0, one - OPENS) * self.density(one) for one in (p, p_far)]
        return [v, sign * outwards / MASS, mass - eased[0], -mass, -eased[1]]

    def solved(
            self, y: np.ndarray, seconds: float, rows: int, is_in: bool = False) -> np.ndarray:
        """
        Return s, v and the three pressures, (rows, 5); ``is_in``: the spear, at the start.

        `solve_ivp` finds where the spear enters and leaves, and begins anew there.
        """
        def crosses(_: float, y: np.ndarray, __: bool) -> float:
            d = y[0] if self.side == 'a' else float(self.oil.stroke) - y[0]
            return float(d - self.length)
        crosses.terminal = True     # type: ignore[attr-defined]
        y = np.array(y)
        times, t, found = np.linspace(0.0, seconds, rows), 0.0, []
        while t < seconds:
            crosses.direction = 1.0 if is_in else -1.0      # type: ignore[attr-defined]
            part = solve_ivp(
                self.rates, (t, seconds), y, 'LSODA', times[times >= t], events=crosses,
                args=(is_in,), first_step=1e-7, rtol=1e-9,
                atol=[1e-13, 1e-10, 1e-16, 1e-16, 1e-16])
            for one in part.y.T if part.t.size else ():
                found.append(self._row(one, is_in))
            if part.status == 0:
                break
            t, y = float(part.t_events[0][0]), part.y_events[0][0].copy()
            is_in = not is_in
            port, trapped, _ = self.volumes(y[0], True)
            total = y[2] + y[3]
            y[3] = total * trapped / (port + trapped) if is_in else 0.0
            y[2] = total - y[3]
        return np.array(found)

    def _row(self, y: np.ndarray, is_in: bool) -> list[float]:
        volumes = self.volumes(y[0], is_in)
        return [y[0], y[1], self.pressure(y[2], volumes[0]),
                self.pressure(y[3], volumes[1]) if is_in else 0.0,
                self.pressure(y[4], volumes[2])]


def _smooth_root(dp: float) -> float:
    return dp / (dp * dp + 1e10) ** 0.25


def masses(cylinder: ClosedCylinder, model: OfMasses) -> tuple[float, float, float]:
    """Return those of port's side, trapped side and other chamber of the kernels' state."""
    own = cylinder.own
    is_in = bool(own.cushion.end != 0.0)
    volumes = model.volumes(float(own.mechanics.position), is_in)
    near, far = (('a', 'b') if model.side == 'a' else ('b', 'a'))
    pressures = [float(getattr(own.chambers, f'p_{near}')), float(own.cushion.p),
                 float(getattr(own.chambers, f'p_{far}'))]
    cavities = [float(getattr(own.chambers, f'cavity_{near}')), float(own.cushion.cavity),
                float(getattr(own.chambers, f'cavity_{far}'))]
    found = [(volume - cavity) * model.density(p)
             for volume, cavity, p in zip(volumes, cavities, pressures)]
    return found[0], found[1], found[2]
