"""
The hydraulic supply all actuators share: constant pressure, or pump and accumulator.

Actuators see the supply pressure of the tick's start over the whole tick and report the
volume they drew; the supply then advances over the same interval. Pressures are gauge.
"""

from dataclasses import dataclass
import math

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.units import LPM, MPA
from isa_ros.errors import ParameterError
import numpy as np

ATMOSPHERE = 101325.0        # Pa, between gauge and the gas law's absolute pressure
SUPPLY_STEP = 1e-4           # s, of the supply's own RK4
_SLOWEST_TICKS = 10.0        # ticks a supply's time constant must last (coupling.md)


@dataclass(frozen=True, kw_only=True)
class ConstantSupply(Parameters):
    """An ideal supply."""

    pressure_mpa: float = parameter('gauge supply pressure', 'MPa', gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter('gauge return pressure', 'MPa', ge=0.0, le=5.0)


@dataclass(frozen=True, kw_only=True)
class AccumulatorSupply(Parameters):
    """A pressure-compensated pump with gas accumulator, line and relief valve."""

    pressure_mpa: float = parameter('gauge pressure the pump holds', 'MPa', gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter('gauge return pressure', 'MPa', ge=0.0, le=5.0)
    gas_volume_l: float = parameter('accumulator gas volume at precharge', 'l', gt=0.0, le=100.0)
    precharge_mpa: float = parameter('gauge gas precharge', 'MPa', gt=0.0, le=70.0)
    polytropic_exponent: float = parameter('n of the gas law', '1', ge=1.0, le=1.7)
    line_volume_l: float = parameter('oil in the line', 'l', gt=0.0, le=100.0)
    bulk_modulus: float = parameter('effective, of the line', 'Pa', gt=0.0, le=2e9)
    pump_flow_lpm: float = parameter('largest pump flow', 'l/min', gt=0.0, le=1000.0)
    pump_lag_s: float = parameter('pump time constant', 's', ge=1e-3, le=10.0)
    pump_band_mpa: float = parameter(
        'pressure below the set point at full flow', 'MPa', gt=0.0, le=10.0)
    relief_mpa: float = parameter('gauge pressure of the relief valve', 'MPa', gt=0.0, le=70.0)
    relief_lpm_per_mpa: float = parameter(
        'relief flow per pressure above opening', 'l/min/MPa', gt=0.0, le=1e3)


SupplySheet = ConstantSupply | AccumulatorSupply

SUPPLY = np.dtype([
    ('p_set', 'f8'), ('p_t', 'f8'), ('v_0', 'f8'), ('p_0', 'f8'), ('n', 'f8'), ('c_line', 'f8'),
    ('q_max', 'f8'), ('lag', 'f8'), ('band', 'f8'), ('p_relief', 'f8'), ('k_relief', 'f8')])
SUPPLY_STATE = np.dtype([('pressure', 'f8'), ('pump_flow', 'f8')])


def supply_record(sheet: AccumulatorSupply) -> np.ndarray:
    """Return the `SUPPLY` record of an accumulator supply, shape (1,)."""
    return np.array([(
        sheet.pressure_mpa * MPA, sheet.return_pressure_mpa * MPA,
        sheet.gas_volume_l * 1e-3, sheet.precharge_mpa * MPA + ATMOSPHERE,
        sheet.polytropic_exponent, sheet.line_volume_l * 1e-3 / sheet.bulk_modulus,
        sheet.pump_flow_lpm * LPM, sheet.pump_lag_s, sheet.pump_band_mpa * MPA,
        sheet.relief_mpa * MPA, sheet.relief_lpm_per_mpa * LPM / MPA)], dtype=SUPPLY)


@kernel
def capacitance(pressure, supply):
    """
    Return V_0/(n P) (p_0/P)^(1/n) + V_line/beta  (C7), in m3/Pa; P absolute.

    Below precharge the accumulator is empty and the line alone is left.
    """
    absolute = pressure + ATMOSPHERE
    if absolute <= supply.p_0:
        return supply.c_line
    gas = supply.v_0 * math.exp(math.log(supply.p_0 / absolute) / supply.n)
    return gas / (supply.n * absolute) + supply.c_line


@kernel
def supply_rates(pressure, pump_flow, drawn, supply):
    """
    Return (dP/dt, dQ_pump/dt) with C dP/dt = Q_pump - Q_drawn - Q_relief  (C8).

    The pump follows its pressure compensator, 0 to full flow over the band, with one lag.
    """
    demand = max(0.0, min(1.0, (supply.p_set - pressure) / supply.band)) * supply.q_max
    relief = max(0.0, supply.k_relief * (pressure - supply.p_relief))
    return ((pump_flow - drawn - relief) / capacitance(pressure, supply),
            (demand - pump_flow) / supply.lag)


@kernel
def supply_advance(steps, drawn, supplies, states):
    """Advance ``states[0]`` by ``steps`` steps of `SUPPLY_STEP` with the mean flow ``drawn``."""
    h, supply, state = SUPPLY_STEP, supplies[0], states[0]
    for _ in range(steps):
        p, q = state.pressure, state.pump_flow
        p_1, q_1 = supply_rates(p, q, drawn, supply)
        p_2, q_2 = supply_rates(p + 0.5 * h * p_1, q + 0.5 * h * q_1, drawn, supply)
        p_3, q_3 = supply_rates(p + 0.5 * h * p_2, q + 0.5 * h * q_2, drawn, supply)
        p_4, q_4 = supply_rates(p + h * p_3, q + h * q_3, drawn, supply)
        state.pressure = p + h / 6.0 * (p_1 + 2.0 * (p_2 + p_3) + p_4)
        state.pump_flow = q + h / 6.0 * (q_1 + 2.0 * (q_2 + q_3) + q_4)


class Supply:
    """
    The supply over a run; `pressure` and `return_pressure` hold for the next tick.

    ``flow_slope`` is the sum of the valves' largest dQ/dP in m3/s/Pa.

    Raises
    ------
    ParameterError
        The supply is too small to hold its pressure over one tick.

    """

    def __init__(self, sheet: SupplySheet, step_ns: int, flow_slope: float) -> None:
        self.return_pressure = sheet.return_pressure_mpa * MPA
        self._step = step_ns * 1e-9
        self._record: np.ndarray | None = None
        self._state = np.zeros(1, SUPPLY_STATE)
        self._state['pressure'] = sheet.pressure_mpa * MPA
        if isinstance(sheet, AccumulatorSupply):
            self._record = supply_record(sheet)
            self._refuse_small(self._record, flow_slope)

    def _refuse_small(self, record: np.ndarray, flow_slope: float) -> None:
        holds = capacitance(self.pressure, record[0]) / flow_slope
        bound = _SLOWEST_TICKS * self._step
        if holds < bound:
            raise ParameterError(
                f'supply: capacitance over flow slope = {holds * 1e3:.3g} ms, '
                f'must be >= {bound * 1e3:.3g} ms (ten ticks); enlarge gas_volume_l')

    @property
    def pressure(self) -> float:
        """Return the gauge supply pressure in Pa."""
        return float(self._state['pressure'][0])

    def advance(self, drawn_volume: float) -> None:
        """Advance one tick in which the actuators drew ``drawn_volume`` (m3)."""
        if self._record is not None:
            steps = round(self._step / SUPPLY_STEP)
            supply_advance(steps, drawn_volume / self._step, self._record, self._state)

    def state(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        return self._state.tobytes()

    def restore(self, state: bytes) -> None:
        """Continue from a `state` of a supply with the same sheet."""
        self._state[:] = np.frombuffer(state, SUPPLY_STATE, 1)
