"""
Data sheets of the servo valve's metering; `isa_ros.plant.servo_valve` has the equations.

Currents are on the series scale of figure 5, flows those of one land with the factor 1.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, parameter, Parameters, section
from isa_ros.core.units import PERCENT
from isa_ros.errors import ParameterError
from isa_ros.plant.hysteresis import refuse_hysteresis, threshold, widest, widest_from
from isa_ros.plant.pressure_gain import PressureGain, refuse_contradiction
from isa_ros.plant.stated_curves import (
    interpolated, NullShift, PointsFlow, SidesFlow, StatedLeakage, StraightFlow)


@frozen(kw_only=True)
class Lap(Parameters):
    """Overlap of each land; negative: underlap."""

    pa_um: float = parameter('land P-A', 'um', ge=-20.0, le=50.0)
    at_um: float = parameter('land A-T', 'um', ge=-20.0, le=50.0)
    bt_um: float = parameter('land B-T', 'um', ge=-20.0, le=50.0)
    pb_um: float = parameter('land P-B', 'um', ge=-20.0, le=50.0)


@frozen(kw_only=True)
class Valve(Parameters):
    """Parameters of every valve; currents on the series scale of figure 5."""

    hysteresis_percent: float = widest()
    threshold_percent: float = threshold()
    hysteresis_from_percent: float = widest_from()
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

    def __post_init__(self) -> None:
        """Refuse a hysteresis that no valve has."""
        super().__post_init__()
        refuse_hysteresis(self)


@frozen(kw_only=True)
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


@frozen(kw_only=True)
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


@frozen(kw_only=True)
class DataSheetValve(Parameters):
    """Servo or proportional valve as its data sheet has it: flow and leakage over current."""

    hysteresis_percent: float = widest()
    threshold_percent: float = threshold()
    hysteresis_from_percent: float = widest_from()
    rated_drop_mpa: float = parameter(
        'pressure drop over both lands at the stated flows', 'MPa', gt=0.0, le=70.0)
    spool_travel_mm: float = parameter(
        'spool travel at the last point of the flow, its stop', 'mm', gt=0.0, le=10.0)
    flow: StraightFlow | PointsFlow | SidesFlow
    leakage: StatedLeakage
    orifice_smoothing_kpa: float = parameter(
        'pressure drop delta below which an orifice is laminar', 'kPa', gt=0.0, le=1000.0)
    slots: str = choice(
        "areas of the lands' slots: matched to the areas of the piston, or all equal",
        'matched', 'equal')
    lap: Lap
    pressure_gain: PressureGain = section(PressureGain)
    null_shift: NullShift = section(NullShift)
    dead_band_percent: float = parameter(
        'current up to which an overlap keeps all lands closed, of the one at the stop', '%',
        absent=0.0, source='assumed, none', ge=0.0, le=50.0)
    compensated_drop_mpa: float = parameter(
        'largest drop over a land from the supply, which a pressure compensator holds; 0: none',
        'MPa', absent=0.0, source='assumed, none', ge=0.0, le=10.0)

    def __post_init__(self) -> None:
        """Refuse a dead band or a pressure gain that contradicts flow or leakage."""
        super().__post_init__()
        refuse_hysteresis(self)
        if self.dead_band_percent > 0.0:
            self._refuse_dead_band()
        if self.pressure_gain.percent > 0.0:
            self._refuse_pressure_gain()

    def _refuse_dead_band(self) -> None:
        first, full = self.flow.currents_ma[1], self.flow.currents_ma[-1]
        end = self.dead_band_percent * PERCENT * full
        if first <= end:
            raise ParameterError(
                f'flow.current_ma[1] = {first:g} mA, must be > {end:g} mA, the dead band of '
                f'dead_band_percent = {self.dead_band_percent:g} %')
        n = len(self.leakage.current_ma)
        if n > 1:
            raise ParameterError(
                f'leakage.current_ma has {n} points, must have 1 with dead_band_percent = '
                f'{self.dead_band_percent:g} %: closed lands leak alike')

    def _refuse_pressure_gain(self) -> None:
        gain, leakage = self.pressure_gain, self.leakage
        for name, value, needed in (
                ('slots', self.slots, 'equal'), ('dead_band_percent', self.dead_band_percent, 0.0),
                ('compensated_drop_mpa', self.compensated_drop_mpa, 0.0)):
            if value != needed:
                raise ParameterError(
                    f'pressure_gain.percent = {gain.percent:g} % and {name} = {value}, must be '
                    f'{needed}: a pressure gain is that of four equal lands around null')
        current = gain.current_percent * PERCENT * self.flow.currents_ma[-1]
        if len(leakage.current_ma) > 1 and leakage.current_ma[1] <= current:
            raise ParameterError(
                f'leakage.current_ma[1] = {leakage.current_ma[1]:g} mA, must be > {current:g} mA: '
                f'there the leakage follows from pressure_gain.percent = {gain.percent:g} %')
        flow = interpolated(self.flow.currents_ma, self.flow.flows_lpm)
        root = math.sqrt(2.0 * leakage.pressure_mpa / self.rated_drop_mpa)
        beyond = None if len(leakage.current_ma) == 1 else (
            leakage.total_lpm[1] - leakage.tare_lpm, flow(leakage.current_ma[1]))
        refuse_contradiction(
            gain, flow(current), root, current,
            (leakage.total_lpm[0] - leakage.tare_lpm, leakage.total_lpm[0]), beyond)

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
        if len(i) != 3 or self.dead_band_percent > 0.0:
            return None
        return i[1], q[1] / i[1] * (i[2] - i[1]) / (q[2] - q[1])
