"""
The pressure line of a pump with an accumulator.

Pressures are gauge, flows leave the line when positive. Equations C7, C8, E7, E9.

Neglected: length and resistance of the line, heat.
"""

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.elementary import exp, expm1, log
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel, kernel_function
from isa_ros.core.parameter import fault, nested, parameter, Parameters
from isa_ros.core.units import LITRE, LPM, MPA
from isa_ros.surroundings.dump import (
    DUMP, dump_fields, dumped, NoneDump, opened_after, ValveDump)
from isa_ros.surroundings.return_line import HeldReturn, ReturnLine, SUPPLY_STEP
from isa_ros.surroundings.supply_port import FedNode, HeldPort, MovingPort
import numpy as np


@frozen(kw_only=True)
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
    dump: NoneDump | ValveDump = nested(NoneDump())
    port: HeldPort | MovingPort = nested(HeldPort())


SUPPLY = np.dtype([
    ('p_set', 'f8'), ('p_t', 'f8'), ('v_0', 'f8'), ('p_0', 'f8'), ('n', 'f8'), ('c_line', 'f8'),
    ('q_max', 'f8'), ('lag', 'f8'), ('band', 'f8'), ('p_relief', 'f8'), ('k_relief', 'f8'),
    ('k_leak', 'f8'), ('dump_valve', DUMP)])


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
            'k_leak': sheet.line_leakage_lpm_per_mpa * LPM / MPA,
            'dump_valve': dump_fields(sheet.dump, SUPPLY_STEP)}.items():
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
def supply_rates(pressure, pump_flow, drawn, opening, supply):
    """
    Return (dP/dt, dQ_pump/dt) with C dP/dt = Q_pump - Q_drawn - Q_relief - Q_leak - Q_dump  (C8).

    The pump follows its pressure compensator, 0 to full flow over the band, with one lag, and
    stops while the line of the dump valve is open; Q_leak = k P, from the line to the outside,
    Q_dump that of a dump valve at its ``opening``  (C14). Then two powers: those of the pump, and
    of relief valve, leak and dump valve, P Q, in W  (E7).
    """
    demand = max(0.0, min(1.0, (supply.p_set - pressure) / supply.band)) * supply.q_max
    relief = max(0.0, supply.k_relief * (pressure - supply.p_relief))
    leak = max(0.0, supply.k_leak * pressure)
    c = capacitance(pressure, supply)
    if supply.dump_valve.is_there > 0.0:
        leak += dumped(pressure, opening, 1.0 / c, supply.dump_valve)
        demand *= 1.0 - supply.dump_valve.is_open
    return ((pump_flow - drawn - relief - leak) / c,
            (demand - pump_flow) / supply.lag, pressure * pump_flow, pressure * (relief + leak))


@kernel_function
def accumulator_node(supply, state):
    """
    Return the line of a `SUPPLY` and its `SUPPLY_SAMPLE` as the `FedNode` of its actuators  (C15).

    The pump's flow follows its lag by itself; relief, leak and dump valve follow the pressure.
    """
    p, dump, dumping = state.pressure, supply.dump_valve, 0.0
    rise, pump_rate, _, _ = supply_rates(p, state.pump_flow, 0.0, state.dump_opening, supply)
    c = capacitance(p, supply)
    if dump.is_there > 0.0 and state.dump_opening > 0.0 and p > 0.0:
        dumping = 0.5 * dumped(p, state.dump_opening, 1.0 / c, dump) / p
    slope = (dumping + (supply.k_relief if p > supply.p_relief else 0.0)
             + (supply.k_leak if p > 0.0 else 0.0))
    return FedNode(p, c, c * rise, slope, pump_rate)


@kernel
def supply_advance(steps, drawn, supplies, states):
    """Advance ``states[0]`` by ``steps`` steps of `SUPPLY_STEP` with the mean flow ``drawn``."""
    h, supply, state = SUPPLY_STEP, supplies[0], states[0]
    held, impulse, before = state.pressure, 0.0, stored_energy(state.pressure, supply)
    dump = supply.dump_valve
    for _ in range(steps):
        p, q, z = state.pressure, state.pump_flow, state.dump_opening
        half, end = opened_after(z, dump.left_half, dump), opened_after(z, dump.left, dump)
        p_1, q_1, e_1, r_1 = supply_rates(p, q, drawn, z, supply)
        p_2, q_2, e_2, r_2 = supply_rates(
            p + 0.5 * h * p_1, q + 0.5 * h * q_1, drawn, half, supply)
        p_3, q_3, e_3, r_3 = supply_rates(
            p + 0.5 * h * p_2, q + 0.5 * h * q_2, drawn, half, supply)
        p_4, q_4, e_4, r_4 = supply_rates(p + h * p_3, q + h * q_3, drawn, end, supply)
        state.dump_opening = end
        state.pressure = p + h / 6.0 * (p_1 + 2.0 * (p_2 + p_3) + p_4)
        state.pump_flow = q + h / 6.0 * (q_1 + 2.0 * (q_2 + q_3) + q_4)
        state.pump_energy += h / 6.0 * (e_1 + 2.0 * (e_2 + e_3) + e_4)
        state.relief_energy += h / 6.0 * (r_1 + 2.0 * (r_2 + r_3) + r_4)
        impulse += h * p + h * h / 6.0 * (p_1 + p_2 + p_3)
    state.stored_energy += stored_energy(state.pressure, supply) - before
    state.held_energy += drawn * (held * (steps * h) - impulse)
