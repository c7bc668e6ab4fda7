"""A cylinder with closed ports: its steps by the kernels, and what scipy says of the same."""

from collections.abc import Callable, Mapping
from dataclasses import replace
import math
from types import MappingProxyType
from typing import Any, NamedTuple

from isa_ros.actuator.integration import integrated, rk4_steps
from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.parameter import Parameters
from isa_ros.core.record import row_record
from isa_ros.core.signals import LOAD_PORT, SUPPLY_PORT
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.plant.service_lines import rest_lines
import numpy as np
from scipy.integrate import solve_ivp
from tests.sheets import actuator_sheet, override


class Chamber(NamedTuple):
    """Pressure (Pa), cavity (m3), and mass over that of a m3 at atmospheric pressure."""

    pressure: float
    cavity: float
    mass: float


class ClosedCylinder:
    """
    An actuator whose valve lets nothing through, at rest at ``place`` (m | rad) and ``pressure``.

    ``values`` are of its sheet, ``oil__dead_volume_ml`` for example. Without ``refill`` both
    chambers are sealed. The load moves as `move` says; of a ``free`` one nothing but the oil acts
    on the piston. ``parts`` replace those of its plant.
    """

    def __init__(
            self, model: str, place: float, pressure: float, *, refill: bool = False,
            free: bool = False, parts: Mapping[str, Parameters] = MappingProxyType({}),
            **values: Any) -> None:
        sheet = actuator_sheet(model)
        sheet = replace(sheet, plant=replace(sheet.plant, **parts))
        for path, value in values.items():
            sheet = override(sheet, f'plant.{path.replace("__", ".")}', value)
        self.constants = actuator_record(sheet, 0)
        self.plant = plant = row_record(self.constants).plant
        plant.valve.per_root_drop = plant.valve.c_tare = 0.0
        plant.chambers.c_li, plant.relief.p_open = 0.0, math.inf
        if not refill:
            plant.relief.c_refill = 0.0
        if free:
            own, seals = plant.mechanics, plant.friction
            own.k_s = own.d_s = seals.sigma0 = seals.sigma1 = seals.sigma2 = 0.0
        self.port = np.zeros(1, LOAD_PORT)
        self.integrated = integrated(
            self.port[0], np.zeros(1, SUPPLY_PORT)[0], self.constants[0])
        self.state = row_record(self.integrated.continuous)
        self.own = self.state.plant
        self.own.mechanics.position = self.state.load.position = place
        self.own.chambers.p_a = self.own.chambers.p_b = pressure
        rest_lines(plant, (pressure, pressure), self.own.lines)

    def move(self, steps: int = 1, acceleration: float = 0.0) -> None:
        """Take plant steps with the load at an acceleration (m/s2 | rad/s2)."""
        self.port['a_bias'] = acceleration
        rk4_steps(steps, PLANT_STEP, 0.0, self.integrated)

    def volumes(self, s: float) -> tuple[float, float]:
        oil = self.plant.chambers
        return (float(oil.dead_volume + oil.area_a * s),
                float(oil.dead_volume + oil.area_b * (oil.stroke - s)))

    def density(self, p: float) -> float:
        """Return that of C5 and C12 over that at atmospheric pressure, by their integrals."""
        oil = self.plant.chambers
        strain = (p if p >= 0.0 else p - 0.5 * p * p / oil.p_air) / oil.beta
        air = oil.air * (101325.0 / (p + 101325.0)) ** (1.0 / 1.4) if oil.air else 0.0
        return float(1.0 / (air + (1.0 - oil.air) * math.exp(-strain)))

    @property
    def chambers(self) -> tuple[Chamber, Chamber]:
        """Return A and B."""
        state, (v_a, v_b) = self.own.chambers, self.volumes(self.own.mechanics.position)
        return (self._chamber(float(state.p_a), float(state.cavity_a), v_a),
                self._chamber(float(state.p_b), float(state.cavity_b), v_b))

    def _chamber(self, p: float, cavity: float, volume: float) -> Chamber:
        return Chamber(p, cavity, (volume - cavity) * self.density(p))


def by_scipy(cylinder: ClosedCylinder, speed: float, times: np.ndarray) -> np.ndarray:
    """
    Return s, v, P_A, W_A, P_B, W_B of a free piston thrown at ``speed``, (n, 6).

    Liquid: C2 with the modulus of C5; boiling: P = P_v and W' = -(Q - A s'). `solve_ivp` finds
    where a chamber begins to boil or its cavity closes, and begins anew there.
    """
    oil, own = cylinder.plant.chambers, cylinder.plant.mechanics
    areas = float(oil.area_a), -float(oil.area_b)
    refill, p_v = float(cylinder.plant.relief.c_refill), float(oil.p_vapour)

    def rates(_: float, y: np.ndarray, boils: list[bool]) -> list[float]:
        s, v = y[:2]
        force, found = 0.0, []
        for k, (area, volume) in enumerate(zip(areas, cylinder.volumes(s))):
            p = p_v if boils[k] else y[2 + 2 * k]
            gained = refill * min(0.0, p) ** 2 - area * v
            beta = oil.beta / (1.0 - min(0.0, p) / oil.p_air)
            found += [0.0, -gained] if boils[k] else [beta / volume * gained, 0.0]
            force += area * p
        return [v, force / own.inertia, *found]

    def falls_to(place: int, level: float) -> Callable[..., float]:
        def event(_: float, y: np.ndarray, __: list[bool]) -> float:
            return float(y[place] - level)
        event.terminal, event.direction = True, -1.0    # type: ignore[attr-defined]
        return event
    p = float(cylinder.own.chambers.p_a)
    y, t = np.array([cylinder.own.mechanics.position, speed, p, 0.0, p, 0.0]), -1e-12
    boils, rows = [False, False], []
    while t < times[-1]:
        events = [falls_to(3 + 2 * k, 0.0) if boils[k] else falls_to(2 + 2 * k, p_v)
                  for k in range(2)]
        found = solve_ivp(
            rates, (t, times[-1]), y, 'DOP853', times[times > t], events=events,
            args=(boils,), rtol=1e-11, atol=[1e-14, 1e-10, 1e-3, 1e-17, 1e-3, 1e-17])
        if len(found.t):
            rows += list(found.y.T)
        if found.status == 0:
            break
        hit = next(k for k, at in enumerate(found.t_events) if len(at))
        t, y = float(found.t_events[hit][0]), found.y_events[hit][0].copy()
        y[2 + 2 * hit], y[3 + 2 * hit] = p_v, 0.0
        boils[hit] = not boils[hit]
    return np.array(rows)
