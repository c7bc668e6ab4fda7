"""
A hydraulic supply: the pump side, and the supply as a whole.

Actuators use both pressures of the tick's start over the whole tick and report the volumes that
they drew and returned; the supply then advances over the same interval. They pay for the oil what
it costs at these held pressures, and that is what the supply gives; by what a line gave more or
less, its pressure having moved meanwhile, is an entry of its own (E9). Pressures are gauge, flows
leave the supply and enter the return line when positive. Equations C7, C8, E7, E9; the return
line is `isa_ros.surroundings.return_line`.

Neglected: length and resistance of the pressure line, heat.
"""

from dataclasses import dataclass

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.elementary import exp, expm1, log
from isa_ros.core.fields import Field, record_type
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, nested, parameter, Parameters
from isa_ros.core.units import LITRE, LPM, MPA
from isa_ros.errors import ParameterError
from isa_ros.surroundings.return_line import (
    HeldReturn, return_advance, return_record, ReturnLine, SUPPLY_STEP, VolumeReturn)
import numpy as np

_SLOWEST_TICKS = 10.0        # shortest time constant in ticks (coupling.md)


@dataclass(frozen=True, kw_only=True)
class ConstantSupply(Parameters):
    """An ideal supply: constant pressure at any flow."""

    pressure_mpa: float = parameter(
        'gauge supply pressure', 'MPa', changeable=True, gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter(
        'gauge return pressure', 'MPa', changeable=True, ge=0.0, le=5.0)
    return_line: ReturnLine = nested(HeldReturn())


@dataclass(frozen=True, kw_only=True)
class AccumulatorSupply(Parameters):
    """A pressure-compensated pump with gas accumulator, line and relief valve."""

    pressure_mpa: float = parameter(
        'gauge pressure the pump holds', 'MPa', changeable=True, gt=0.0, le=70.0)
    return_pressure_mpa: float = parameter(
        'gauge return pressure', 'MPa', changeable=True, ge=0.0, le=5.0)
    gas_volume_l: float = parameter('accumulator gas volume at precharge', 'l', gt=0.0, le=100.0)
    precharge_mpa: float = parameter('gauge gas precharge', 'MPa', gt=0.0, le=70.0)
    polytropic_exponent: float = parameter('n of the gas law', '1', ge=1.0, le=1.7)
    line_volume_l: float = parameter('oil in the line', 'l', gt=0.0, le=100.0)
    bulk_modulus: float = parameter('effective, of the line', 'Pa', gt=0.0, le=2e9)
    pump_flow_lpm: float = parameter(
        'largest pump flow; 0: the pump stands', 'l/min', changeable=True, ge=0.0, le=1000.0)
    pump_lag_s: float = parameter('pump time constant', 's', ge=1e-3, le=10.0)
    pump_band_mpa: float = parameter(
        'pressure below the set point at full flow', 'MPa', gt=0.0, le=10.0)
    relief_mpa: float = parameter(
        'gauge pressure of the relief valve', 'MPa', changeable=True, gt=0.0, le=70.0)
    relief_lpm_per_mpa: float = parameter(
        'relief flow per pressure above opening', 'l/min/MPa', gt=0.0, le=1e3)
    accumulator_lost: float = fault(
        '1: the accumulator has lost its gas', '1', is_whole=True, ge=0.0, le=1.0)
    line_leakage_lpm_per_mpa: float = fault(
        'flow from the pressure line to the outside per pressure', 'l/min/MPa', ge=0.0, le=10.0)
    return_line: ReturnLine = nested(HeldReturn())


SupplySheet = ConstantSupply | AccumulatorSupply

SUPPLY = np.dtype([
    ('p_set', 'f8'), ('p_t', 'f8'), ('v_0', 'f8'), ('p_0', 'f8'), ('n', 'f8'), ('c_line', 'f8'),
    ('q_max', 'f8'), ('lag', 'f8'), ('band', 'f8'), ('p_relief', 'f8'), ('k_relief', 'f8'),
    ('k_leak', 'f8')])
SUPPLY_FIELDS = (
    Field('pressure', 'Pa', 'gauge'),
    Field('return_pressure', 'Pa', 'gauge'),
    Field('pump_flow', 'm3/s', '0 for an ideal supply'),
    Field('drawn', 'm3', 'volume drawn by the actuators since t = 0'),
    Field('returned', 'm3', 'volume returned by the actuators since t = 0'),
    Field('power', 'W', 'of the oil drawn less that returned, mean over the tick'),
    Field('peak_power', 'W', 'greatest power since t = 0'),
    Field('energy', 'J', 'integral of the power since t = 0'),
    Field('pump_energy', 'J', 'of the pump since t = 0'),
    Field('relief_energy', 'J', 'lost through the relief valve since t = 0'),
    Field('return_energy', 'J', 'lost on the way of returned oil to the tank since t = 0'),
    Field('stored_energy', 'J', 'in accumulator and lines, more than at t = 0'),
    Field('held_energy', 'J', 'paid at pressures held over a tick, not given by a line'),
)
"""The state of one supply, which is also its sample at the end of a tick."""
SUPPLY_SAMPLE = record_type(SUPPLY_FIELDS)


def supply_record(sheet: AccumulatorSupply) -> np.ndarray:
    """Return the `SUPPLY` record of an accumulator supply, shape (1,)."""
    record = np.zeros(1, SUPPLY)
    for name, value in {
            'p_set': sheet.pressure_mpa * MPA, 'p_t': sheet.return_pressure_mpa * MPA,
            'v_0': 0.0 if sheet.accumulator_lost else sheet.gas_volume_l * LITRE,
            'p_0': sheet.precharge_mpa * MPA + ATMOSPHERE,
            'n': sheet.polytropic_exponent,
            'c_line': sheet.line_volume_l * LITRE / sheet.bulk_modulus,
            'q_max': sheet.pump_flow_lpm * LPM, 'lag': sheet.pump_lag_s,
            'band': sheet.pump_band_mpa * MPA, 'p_relief': sheet.relief_mpa * MPA,
            'k_relief': sheet.relief_lpm_per_mpa * LPM / MPA,
            'k_leak': sheet.line_leakage_lpm_per_mpa * LPM / MPA}.items():
        record[name] = value
    return record


@kernel
def capacitance(pressure, supply):
    """
    Return V_0/(n P) (p_0/P)^(1/n) + V_line/beta  (C7), in m3/Pa; P absolute.

    Below precharge the accumulator is empty and only the line remains; likewise with V_0 = 0, an
    accumulator that has lost its gas.
    """
    absolute = pressure + ATMOSPHERE
    if absolute <= supply.p_0:
        return supply.c_line
    gas = supply.v_0 * exp(log(supply.p_0 / absolute) / supply.n)
    return gas / (supply.n * absolute) + supply.c_line


@kernel
def stored_energy(pressure, supply):
    """
    Return the integral of P C dP from 0 to ``pressure``  (E9), in J.

    Of the line V P^2/(2 beta); of the gas, above precharge, p_0 V_0 expm1(k x)/(n k) less the
    atmosphere's share, x = ln(P/p_0), k = (n - 1)/n, P absolute; p_0 V_0 x for n = 1.
    """
    line = 0.5 * supply.c_line * pressure * pressure
    absolute = pressure + ATMOSPHERE
    if absolute <= supply.p_0:
        return line
    x, n = log(absolute / supply.p_0), supply.n
    k = (n - 1.0) / n
    grown = expm1(k * x) / k if k > 0.0 else x
    return line + supply.v_0 * (supply.p_0 * grown / n + ATMOSPHERE * expm1(-x / n))


@kernel
def supply_rates(pressure, pump_flow, drawn, supply):
    """
    Return (dP/dt, dQ_pump/dt) with C dP/dt = Q_pump - Q_drawn - Q_relief - Q_leak  (C8).

    The pump follows its pressure compensator, 0 to full flow over the band, with one lag;
    Q_leak = k P, from the line to the outside. Then two powers: those of the pump, and of relief
    valve and leak, P Q, in W  (E7).
    """
    demand = max(0.0, min(1.0, (supply.p_set - pressure) / supply.band)) * supply.q_max
    relief = max(0.0, supply.k_relief * (pressure - supply.p_relief))
    leak = max(0.0, supply.k_leak * pressure)
    return ((pump_flow - drawn - relief - leak) / capacitance(pressure, supply),
            (demand - pump_flow) / supply.lag, pressure * pump_flow, pressure * (relief + leak))


@kernel
def supply_advance(steps, drawn, supplies, states):
    """Advance ``states[0]`` by ``steps`` steps of `SUPPLY_STEP` with the mean flow ``drawn``."""
    h, supply, state = SUPPLY_STEP, supplies[0], states[0]
    held, impulse, before = state.pressure, 0.0, stored_energy(state.pressure, supply)
    for _ in range(steps):
        p, q = state.pressure, state.pump_flow
        p_1, q_1, e_1, r_1 = supply_rates(p, q, drawn, supply)
        p_2, q_2, e_2, r_2 = supply_rates(p + 0.5 * h * p_1, q + 0.5 * h * q_1, drawn, supply)
        p_3, q_3, e_3, r_3 = supply_rates(p + 0.5 * h * p_2, q + 0.5 * h * q_2, drawn, supply)
        p_4, q_4, e_4, r_4 = supply_rates(p + h * p_3, q + h * q_3, drawn, supply)
        state.pressure = p + h / 6.0 * (p_1 + 2.0 * (p_2 + p_3) + p_4)
        state.pump_flow = q + h / 6.0 * (q_1 + 2.0 * (q_2 + q_3) + q_4)
        state.pump_energy += h / 6.0 * (e_1 + 2.0 * (e_2 + e_3) + e_4)
        state.relief_energy += h / 6.0 * (r_1 + 2.0 * (r_2 + r_3) + r_4)
        impulse += h * p + h * h / 6.0 * (p_1 + p_2 + p_3)
    state.stored_energy += stored_energy(state.pressure, supply) - before
    state.held_energy += drawn * (held * (steps * h) - impulse)


@kernel
def add_oil(drawn, returned, seconds, states):
    """Add the volumes of one tick (m3), and their energy at the pressures held over it  (E1)."""
    state = states[0]
    energy = state.pressure * drawn - state.return_pressure * returned
    state.drawn += drawn
    state.returned += returned
    state.power = energy / seconds
    state.peak_power = max(state.peak_power, state.power)
    state.energy += energy


class Supply:
    """
    One supply over a run.

    ``flow_slope`` is the sum of the valves' largest dQ/dP in m3/s/Pa; ``state`` is the supply's
    `SUPPLY_SAMPLE` row, shape (1,); None: a new row is made. ``name`` is used in errors.

    Raises
    ------
    ParameterError
        The supply or its return line is too small to hold its pressure over one tick, or the
        return line is too fast for its integration.

    """

    def __init__(
            self, sheet: SupplySheet, step_ns: int, flow_slope: float,
            state: np.ndarray | None = None, name: str = 'supply') -> None:
        self._name = name
        self._step = step_ns * 1e-9
        self._flow_slope = flow_slope
        self._substeps = round(self._step / SUPPLY_STEP)
        self.state = np.zeros(1, SUPPLY_SAMPLE) if state is None else state
        self.state['pressure'] = sheet.pressure_mpa * MPA
        self.state['return_pressure'] = sheet.return_pressure_mpa * MPA
        self._record, self._line = self._records(sheet)

    def change(self, sheet: SupplySheet) -> None:
        """
        Continue with other values of the sheet: pressure and pump flow keep theirs.

        Only an ideal supply, and a return line that is held, take the new pressure at once.
        Raises as the class.
        """
        self._record, self._line = self._records(sheet)
        if self._record is None:
            self.state['pressure'] = sheet.pressure_mpa * MPA
        if self._line is None:
            self.state['return_pressure'] = sheet.return_pressure_mpa * MPA

    def refuse(self, sheet: SupplySheet) -> None:
        """Refuse a sheet with which `change` cannot continue; raises as the class."""
        self._records(sheet)

    def _records(self, sheet: SupplySheet) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Return the `SUPPLY` and the `RETURN_LINE` of a sheet, None for what is ideal."""
        supply = line = None
        if isinstance(sheet, AccumulatorSupply):
            supply = supply_record(sheet)
            self._refuse_small(
                'capacitance', capacitance(sheet.pressure_mpa * MPA, supply[0]), 'gas_volume_l')
        if isinstance(sheet.return_line, VolumeReturn):
            line = return_record(sheet.return_line, sheet.return_pressure_mpa * MPA)
            self._refuse_small(
                'capacitance of the return line', float(line['c'][0]),
                'return_line.oil_volume_l')
            self._refuse_fast(line[0])
        return supply, line

    def _refuse_small(self, what: str, c: float, key: str) -> None:
        holds, bound = c / self._flow_slope, _SLOWEST_TICKS * self._step
        if holds < bound:
            raise ParameterError(
                f'{self._name}: {what} over flow slope = {holds * 1e3:.3g} ms, '
                f'must be >= {bound * 1e3:.3g} ms (ten ticks); enlarge {key}')

    def _refuse_fast(self, line: np.void) -> None:
        """Refuse a return line whose time constant C/G is below the step of the integration."""
        constant = float(line['c'] / line['g'])
        if constant < SUPPLY_STEP:
            raise ParameterError(
                f'{self._name}: time constant of the return line = {constant * 1e3:.3g} ms, '
                f'must be >= {SUPPLY_STEP * 1e3:g} ms; reduce return_line.tank_lpm_per_mpa')

    @property
    def pressure(self) -> float:
        """Return the gauge supply pressure in Pa, constant over the next tick."""
        return float(self.state['pressure'][0])

    @property
    def return_pressure(self) -> float:
        """Return the gauge return pressure in Pa, constant over the next tick."""
        return float(self.state['return_pressure'][0])

    def advance(self, drawn: float, returned: float = 0.0) -> None:
        """Advance one tick in which the actuators drew and returned these volumes (m3)."""
        add_oil(drawn, returned, self._step, self.state)
        if self._record is None:
            self.state['pump_energy'] += self.state['pressure'] * drawn
        else:
            supply_advance(self._substeps, drawn / self._step, self._record, self.state)
        if self._line is None:
            self.state['return_energy'] += self.state['return_pressure'] * returned
        else:
            return_advance(self._substeps, returned / self._step, self._line, self.state)
