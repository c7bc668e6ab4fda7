"""
Data sheets of the servo valve's metering; `isa_ros.plant.servo_valve` has the equations.

Currents are on the series scale of figure 5, flows those of one land with the factor 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from isa_ros.core.parameter import choice, numbers, parameter, Parameters
from isa_ros.core.piecewise import POINTS
from isa_ros.errors import ParameterError
from isa_ros.plant.hysteresis import Hysteretic


@dataclass(frozen=True, kw_only=True)
class Lap(Parameters):
    """Overlap of each land; negative: underlap."""

    pa_um: float = parameter('land P-A', 'um', ge=-20.0, le=50.0)
    at_um: float = parameter('land A-T', 'um', ge=-20.0, le=50.0)
    bt_um: float = parameter('land B-T', 'um', ge=-20.0, le=50.0)
    pb_um: float = parameter('land P-B', 'um', ge=-20.0, le=50.0)


@dataclass(frozen=True, kw_only=True)
class Valve(Hysteretic):
    """Parameters of every valve; currents on the series scale of figure 5."""

    spool_gain_mm_per_ma: float = parameter(
        'spool travel per series current, K_spool (eq 9)', 'mm/mA', gt=0.0, le=1.0)
    spool_stop_mm: float = parameter('largest spool travel', 'mm', gt=0.0, le=1.0)
    land_drop_mpa: float = parameter(
        'pressure drop over one land at the stated flows', 'MPa', gt=0.0, le=50.0)
    null_leakage_lpm: float = parameter(
        'leakage q_0 of one closed land at null', 'l/min', changeable=True, ge=0.0, le=2.0)
    leakage_travel_um: float = parameter(
        'travel x_l that halves the leakage of a land', 'um', gt=0.0, le=100.0)
    tare_leakage_lpm: float = parameter(
        'pilot-stage flow at the tare pressure', 'l/min', ge=0.0, le=2.0)
    tare_pressure_mpa: float = parameter(
        'supply above return pressure of the tare leakage', 'MPa', gt=0.0, le=50.0)
    orifice_smoothing_kpa: float = parameter(
        'pressure drop delta below which an orifice is laminar', 'kPa', gt=0.0, le=1000.0)
    slots: str = choice(
        "areas of the lands' slots: matched to the areas of the piston, or all equal",
        'matched', 'equal')
    lap: Lap


@dataclass(frozen=True, kw_only=True)
class DualGainValve(Valve):
    """Ultra-low-leakage valve: a low flow gain about null, a high one beyond."""

    low_gain_lpm_per_ma: float = parameter(
        'flow gain of one land below the dual-gain point', 'l/min/mA', gt=0.0, le=100.0)
    high_gain_lpm_per_ma: float = parameter(
        'flow gain of one land beyond the dual-gain point', 'l/min/mA', gt=0.0, le=100.0)
    dual_gain_point_mm: float = parameter('spool travel x_dg', 'mm', gt=0.0, le=1.0)

    @property
    def bend(self) -> tuple[float, float] | None:
        """Return the series current (mA) at the bend and the slope before it over that behind."""
        return (self.dual_gain_point_mm / self.spool_gain_mm_per_ma,
                self.low_gain_lpm_per_ma / self.high_gain_lpm_per_ma)


@dataclass(frozen=True, kw_only=True)
class HighResponseValve(Valve):
    """High-response valve: one flow gain about null that falls off towards full flow."""

    gain_lpm_per_ma: float = parameter(
        'flow gain of one land up to its knee', 'l/min/mA', gt=0.0, le=100.0)
    knee_ma: float = parameter('series current at which the gain begins to fall', 'mA',
                               gt=0.0, le=50.0)
    remaining_lpm: float = parameter(
        'flow beyond that of the knee, for any current', 'l/min', gt=0.0, le=100.0)

    @property
    def bend(self) -> tuple[float, float] | None:
        """Return None: the curve is not two straight lines."""
        return None


@dataclass(frozen=True, kw_only=True)
class StraightFlow(Parameters):
    """Flow proportional to the current, up to the rated one."""

    rated_current_ma: float = parameter('series current of the rated flow', 'mA', gt=0.0, le=1e3)
    rated_flow_lpm: float = parameter(
        'flow at that current and the rated drop', 'l/min', gt=0.0, le=1e3)

    @property
    def currents_ma(self) -> tuple[float, ...]:
        """Return the currents of the curve's points."""
        return 0.0, self.rated_current_ma

    @property
    def flows_lpm(self) -> tuple[float, ...]:
        """Return the flows of the curve's points."""
        return 0.0, self.rated_flow_lpm


@dataclass(frozen=True, kw_only=True)
class PointsFlow(Parameters):
    """Flow over current as points, with straight lines between them."""

    current_ma: tuple[float, ...] = numbers(
        'series current of each point, from 0', 'mA', least=2, most=POINTS, ge=0.0, le=1e3)
    flow_lpm: tuple[float, ...] = numbers(
        'flow of each point at the rated drop, from 0', 'l/min', least=2, most=POINTS, ge=0.0,
        le=1e3)

    def __post_init__(self) -> None:
        """Refuse points that do not rise from the origin."""
        super().__post_init__()
        _refuse_falling('current_ma', self.current_ma, 'mA')
        _refuse_falling('flow_lpm', self.flow_lpm, 'l/min')
        _refuse_unpaired(self.current_ma, 'flow_lpm', self.flow_lpm)

    @property
    def currents_ma(self) -> tuple[float, ...]:
        """Return the currents of the curve's points."""
        return self.current_ma

    @property
    def flows_lpm(self) -> tuple[float, ...]:
        """Return the flows of the curve's points."""
        return self.flow_lpm


@dataclass(frozen=True, kw_only=True)
class StatedLeakage(Parameters):
    """Leakage from supply to return over current as points, with both ports shut."""

    pressure_mpa: float = parameter(
        'supply above return pressure of the leakage', 'MPa', gt=0.0, le=70.0)
    current_ma: tuple[float, ...] = numbers(
        'series current of each point, from 0', 'mA', least=1, most=POINTS, ge=0.0, le=1e3)
    total_lpm: tuple[float, ...] = numbers(
        'leakage of each point, pilot stage included', 'l/min', least=1, most=POINTS, ge=0.0,
        le=100.0)
    tare_lpm: float = parameter('of it, that of the pilot stage', 'l/min', ge=0.0, le=100.0)

    def __post_init__(self) -> None:
        """Refuse currents that do not rise from 0, and totals below the pilot stage's."""
        super().__post_init__()
        _refuse_falling('current_ma', self.current_ma, 'mA')
        _refuse_unpaired(self.current_ma, 'total_lpm', self.total_lpm)
        for k, total in enumerate(self.total_lpm):
            if total < self.tare_lpm:
                raise ParameterError(
                    f'total_lpm[{k}] = {total:g} l/min, must be >= tare_lpm = '
                    f'{self.tare_lpm:g} l/min')


def _refuse_falling(name: str, values: Sequence[float], unit: str) -> None:
    if values[0] != 0.0:
        raise ParameterError(f'{name}[0] = {values[0]:g} {unit}, must be 0 {unit}')
    for k in range(1, len(values)):
        if not values[k] > values[k - 1]:
            raise ParameterError(
                f'{name}[{k}] = {values[k]:g} {unit}, must be > {name}[{k - 1}] = '
                f'{values[k - 1]:g} {unit}')


def _refuse_unpaired(currents: Sequence[float], name: str, values: Sequence[float]) -> None:
    if len(currents) != len(values):
        raise ParameterError(
            f'{name} has {len(values)} points, must have {len(currents)} as current_ma')


@dataclass(frozen=True, kw_only=True)
class DataSheetValve(Hysteretic):
    """Servo valve as its data sheet has it: flow and leakage over current, the same both ways."""

    rated_drop_mpa: float = parameter(
        'pressure drop over both lands at the stated flows', 'MPa', gt=0.0, le=70.0)
    spool_travel_mm: float = parameter(
        'spool travel at the last point of the flow, its stop', 'mm', gt=0.0, le=10.0)
    flow: StraightFlow | PointsFlow
    leakage: StatedLeakage
    orifice_smoothing_kpa: float = parameter(
        'pressure drop delta below which an orifice is laminar', 'kPa', gt=0.0, le=1000.0)
    slots: str = choice(
        "areas of the lands' slots: matched to the areas of the piston, or all equal",
        'matched', 'equal')
    lap: Lap

    @property
    def spool_gain_mm_per_ma(self) -> float:
        """Return the spool travel per series current."""
        return self.spool_travel_mm / self.flow.currents_ma[-1]

    @property
    def spool_stop_mm(self) -> float:
        """Return the largest spool travel."""
        return self.spool_travel_mm

    @property
    def bend(self) -> tuple[float, float] | None:
        """Return current (mA) and ratio of slopes at the bend of two lines, None for others."""
        i, q = self.flow.currents_ma, self.flow.flows_lpm
        if len(i) != 3:
            return None
        return i[1], q[1] / i[1] * (i[2] - i[1]) / (q[2] - q[1])
