"""A cylinder behind hoses and load-holding valves, by the kernels and by scipy as one ODE."""

from dataclasses import dataclass, field
import math
from typing import Any

from isa_ros.core.parameter import Parameters
from isa_ros.plant.cavitation import lack
from isa_ros.plant.counterbalance import CounterbalanceHolding
from isa_ros.plant.hose_sheets import ExpandingWall, LumpedHoses, smooth_drop
from isa_ros.plant.load_holding import NoneHolding
from isa_ros.plant.pilot_check import PilotCheckHolding
from isa_ros.plant.service_lines import sensed_pressures
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from tests.actuator.closed_cylinder import ClosedCylinder

HOSES = LumpedHoses(
    inner_diameter_mm=10.0, length_m=1.0, wall=ExpandingWall(
        expansion_ml_per_m=1.5, pressure_mpa=20.0), viscosity_mm2_per_s=46.0, density=870.0,
    rated_lpm=40.0, rated_drop_mpa=1.2)
CHECK = PilotCheckHolding(
    pilot_ratio=4.0, cracking_mpa=0.3, opening_mpa=0.4, rated_lpm=40.0, rated_drop_mpa=0.5,
    leakage_lpm=2.5e-4, lag_ms=5.0, drain='line')
COUNTERBALANCE = CounterbalanceHolding(
    pilot_ratio=3.0, setting_mpa=12.0, opening_mpa=4.0, rated_lpm=30.0, rated_drop_mpa=3.0,
    check_cracking_mpa=0.2, check_opening_mpa=0.2, check_rated_lpm=60.0, check_rated_drop_mpa=0.5,
    leakage_lpm=2.5e-4, lag_ms=5.0, spring_chamber='line')
VALUES = {'oil__dead_volume_ml': 40.0, 'mechanics__inertia': 60.0}
"""Oil and mass of which a step resolves all: C42 and V18 do nothing."""


def hosed(place: float = 0.05, pressure: float = 8e6, holding_a: Parameters = NoneHolding(),
          holding_b: Parameters = NoneHolding(), hoses: LumpedHoses = HOSES,
          **values: float) -> ClosedCylinder:
    """Return an ISA v5 with hoses, whose piston only the oil moves and whose valve is shut."""
    return ClosedCylinder(
        'isa_v5', place, pressure, free=True,
        parts={'hoses': hoses, 'holding_a': holding_a, 'holding_b': holding_b},
        **VALUES | values)


def masses(cylinder: ClosedCylinder) -> np.ndarray:
    """Return the oil of chamber A with its hose and of B with its, m3 at atmospheric pressure."""
    own, hoses, soft = cylinder.own.lines, cylinder.plant.hoses, _soft(cylinder)
    at_atmosphere = -lack(0.0, 0.0, 1.0, hoses) + 1.0   # over that of boiling oil
    return np.array([chamber.mass + (soft - float(lacking)) / at_atmosphere for chamber, lacking
                     in zip(cylinder.chambers, (own.lack_a, own.lack_b))])


def _soft(cylinder: ClosedCylinder) -> float:
    """Return the volume of oil that is as soft as a hose, m3."""
    own = cylinder.plant.hoses
    return float(own.volume * (1.0 + cylinder.plant.chambers.beta * own.per_wall))


@dataclass
class OneOde:
    """
    The same from the equations, with pressures as states and nothing eased.

    ``lands``: K of P-A, A-T, B-T, P-B in m3/s/sqrt(Pa); ``force`` on the rod, N.
    """

    cylinder: ClosedCylinder
    hoses: LumpedHoses = HOSES
    holding: tuple[Any, Any] = (NoneHolding(), NoneHolding())
    lands: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    supply: float = 20e6
    force: float = 0.0
    bursts: tuple[float, float] = (0.0, 0.0)
    delta: float = field(init=False)

    def __post_init__(self) -> None:
        plant = self.cylinder.plant
        self.delta, self.beta = float(plant.valve.delta), float(plant.chambers.beta)
        self.soft = _soft(self.cylinder)

    def drop_of(self, flow: float, square: float) -> float:
        """Return the drop over hose, fittings and valve at a flow > 0."""
        rated = self.hoses.rated_lpm / 60e3
        rest = self.hoses.rated_drop_mpa * 1e6 - smooth_drop(self.hoses, rated)
        return (smooth_drop(self.hoses, flow) + rest * (flow / rated) ** 2
                + square * flow * flow)

    def flow(self, drop: float, square: float) -> float:
        """Return the flow at a drop, by a bracketing solver."""
        size = abs(drop)
        if size < 1e-3 or math.isinf(square):
            return 0.0
        found = brentq(lambda q: self.drop_of(q, square) - size, 0.0, 1.0, xtol=1e-19, rtol=1e-13)
        return math.copysign(float(found), drop)

    def opening(self, sheet: Any, lift: float, line: float, load: float,
                pilot: float) -> tuple[float, float]:
        """Return 1/K^2 of a line's valve and the rate of its lift."""
        if isinstance(sheet, NoneHolding):
            return 0.0, 0.0
        if isinstance(sheet, PilotCheckHolding):
            by_check = (line - load - sheet.cracking_mpa * 1e6) / (sheet.opening_mpa * 1e6)
            behind = line if sheet.drain == 'line' else 0.0
            by_pilot = (sheet.pilot_ratio * (pilot - behind) - (load - line)
                        - sheet.cracking_mpa * 1e6) / (sheet.opening_mpa * 1e6)
            whole = sheet.rated_lpm / 60e3 / math.sqrt(sheet.rated_drop_mpa * 1e6)
        else:
            by_check = (line - load - sheet.check_cracking_mpa * 1e6) / (
                sheet.check_opening_mpa * 1e6)
            effective = load + sheet.pilot_ratio * pilot - sheet.setting_mpa * 1e6
            if sheet.spring_chamber == 'line':
                effective -= (1.0 + sheet.pilot_ratio) * line
            by_pilot = effective / (sheet.opening_mpa * 1e6)
            whole = (sheet.check_rated_lpm / 60e3 / math.sqrt(sheet.check_rated_drop_mpa * 1e6)
                     if line > load else
                     sheet.rated_lpm / 60e3 / math.sqrt(sheet.rated_drop_mpa * 1e6))
        shut = sheet.leakage_lpm / 60e3 / math.sqrt(21e6)
        k = shut + lift * (whole - shut)
        target = min(1.0, max(0.0, by_check, by_pilot))
        return 1.0 / (k * k) if k else math.inf, (target - lift) / (sheet.lag_ms * 1e-3)

    def root(self, drop: float) -> float:
        return drop / (drop * drop + self.delta ** 2) ** 0.25

    def rates(self, _: float, y: np.ndarray) -> list[float]:
        """Return d(s, v, P_A, P_B, H_A, H_B, z_A, z_B)/dt above the atmosphere."""
        s, v, p_a, p_b, h_a, h_b, z_a, z_b = y
        oil, mass = self.cylinder.plant.chambers, float(self.cylinder.plant.mechanics.inertia)
        pa, at, bt, pb = self.lands
        nets = (pa * self.root(self.supply - h_a) - at * self.root(h_a) - self.bursts[0]
                * math.sqrt(max(0.0, h_a)),
                pb * self.root(self.supply - h_b) - bt * self.root(h_b) - self.bursts[1]
                * math.sqrt(max(0.0, h_b)))
        found = []
        for p, h, other, z, sheet, net, sweep, volume in zip(
                (p_a, p_b), (h_a, h_b), (h_b, h_a), (z_a, z_b), self.holding, nets,
                (oil.area_a * v, -oil.area_b * v), self.cylinder.volumes(s)):
            square, rate = self.opening(sheet, z, h, p, other)
            flow = self.flow(h - p, square)
            denser = math.exp((p - h) / self.beta)
            found.append((self.beta / volume * (flow - sweep),
                          self.beta / self.soft * (net - denser * flow), rate))
        (dp_a, dh_a, dz_a), (dp_b, dh_b, dz_b) = found
        force = oil.area_a * p_a - oil.area_b * p_b + self.force
        return [v, force / mass, dp_a, dp_b, dh_a, dh_b, dz_a, dz_b]

    def at(self, times: np.ndarray, start: list[float]) -> np.ndarray:
        """Return the states at times, (n, 8)."""
        found = solve_ivp(
            self.rates, (0.0, times[-1]), start, 'LSODA', times, rtol=1e-9,
            atol=[1e-12, 1e-9, 1e-1, 1e-1, 1e-1, 1e-1, 1e-9, 1e-9], max_step=2e-4)
        assert found.success
        return np.array(found.y.T)


def state(cylinder: ClosedCylinder) -> list[float]:
    """Return what `OneOde.rates` has as states."""
    own = cylinder.own
    h_a, h_b = sensed_pressures(own, cylinder.plant)
    return [float(x) for x in (
        own.mechanics.position, own.mechanics.velocity, own.chambers.p_a, own.chambers.p_b,
        h_a, h_b, own.lines.lift_a, own.lines.lift_b)]
