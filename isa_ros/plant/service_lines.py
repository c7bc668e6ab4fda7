"""
From the servo valve to the two chambers: what flows, and what the way costs.

Servo valve, block valves, hoses, load-holding valves, chambers: all but the first and last may
be absent. Flows are positive INTO a chamber, ``q_p`` OUT OF the supply, ``q_t`` INTO the return.
The pressure sensors are in the valve block: they read the hoses where there are any.
"""

from isa_ros.core.kernel import kernel, kernel_function
from isa_ros.plant import block_valve, chambers, hose, load_holding, servo_valve
from isa_ros.plant.cavitation import lack
from isa_ros.plant.counterbalance import (
    counterbalance_excess, counterbalance_record, CounterbalanceHolding)
from isa_ros.plant.load_holding import COUNTERBALANCE, NO_HOLDING, NoneHolding
from isa_ros.plant.pilot_check import pilot_check_excess, pilot_check_record, PilotCheckHolding
import numpy as np

Holding = NoneHolding | PilotCheckHolding | CounterbalanceHolding


def holding_record(sheet: Holding) -> np.record:
    """Return the `HOLDING` record of a sheet."""
    if isinstance(sheet, PilotCheckHolding):
        return pilot_check_record(sheet)
    if isinstance(sheet, CounterbalanceHolding):
        return counterbalance_record(sheet)
    return load_holding.no_holding()


@kernel
def rigid_lines(y, p_a, p_b, per_a, per_b, p_s, p_t, plant, rates, counts, powers):
    """
    Return (q_a, q_b, q_p, q_t) in m3/s of a valve whose lines to the chambers hold no oil.

    ``per_a`` and ``per_b`` are the elastances of the chambers, in Pa/m3. Writes the rate of the
    poppets' lift, and into ``powers`` leakage and throttling in W if it ``counts``  (E2).
    """
    opened, leaks = servo_valve.conductances(y.spool.position, plant.valve)
    line_a, line_b = p_a, p_b   # between servo valve and poppets, where there are any
    if plant.block.is_on > 0.0:
        z, delta = y.block.lift, plant.valve.delta
        line_a, delta_a = block_valve.blocked_line(
            opened[0], opened[1], z, p_s, p_t, p_a, per_a, delta, plant.block)
        line_b, delta_b = block_valve.blocked_line(
            opened[3], opened[2], z, p_s, p_t, p_b, per_b, delta, plant.block)
        roots = servo_valve.smoothed_roots(line_a, line_b, p_s, p_t, delta_a, delta_b)
        rates.block.lift = plant.block.slew
    else:
        roots = servo_valve.root_drops(opened, p_a, p_b, p_s, p_t, per_a, per_b, plant.valve)
    q_a, q_b, q_p, q_t = servo_valve.metered(opened, roots)
    if counts:
        powers.leakage, powers.throttling = servo_valve.land_losses(
            opened, leaks, roots, line_a, line_b, p_s, p_t)
        if plant.block.is_on > 0.0:
            powers.throttling += q_a * (line_a - p_a) + q_b * (line_b - p_b)
    return q_a, q_b, q_p, q_t


@kernel
def held_flow(line, load, pilot, lift, even, elastance, holding, hoses):
    """
    Return the flow from a hose into its chamber (m3/s) and the rate of the lift (1/s).

    Pressures of the hose, its chamber and the other hose, Pa; ``even`` and ``elastance`` are
    those of `hose.hose_flow`.
    """
    drop = line - load
    if holding.kind == NO_HOLDING:
        return hose.hose_flow(drop, 0.0, even, elastance, hoses), 0.0
    if holding.kind == COUNTERBALANCE:
        excess = counterbalance_excess(load, line, pilot, holding)
    else:
        excess = pilot_check_excess(load, line, pilot, holding)
    rate = load_holding.lift_rate(lift, excess, load, line, holding)
    square = load_holding.poppet_square(drop, lift, holding)
    if square < 0.0:
        return 0.0, rate
    return hose.hose_flow(drop, square, even, elastance, hoses), rate


@kernel
def even_flow(net, gained, at_hose, at_chamber):
    """
    Return the flow from hose to chamber at which their pressures change alike, in m3/s  (C42).

    ``net`` is what the hose gets, ``gained`` what the chamber gains without this flow; elastances
    in Pa/m3, 0 of boiling oil.
    """
    both = at_hose + at_chamber
    return (at_hose * net - at_chamber * gained) / both if both > 0.0 else 0.0


@kernel
def hosed_lines(y, oil_a, oil_b, v, p_s, p_t, per_s, plant, rates, counts, powers):
    """
    Return `rigid_lines` through hoses, and the powers that they store and lose outside, W.

    ``oil_a`` and ``oil_b`` are pressure, elastance and `denser` of the chambers, ``per_s`` is the
    elastance of the supply. The oil that leaves a hose is what its chamber gets, by its mass: e Q
    of both ends are equal  (C40).
    """
    own, state = plant.hoses, y.lines
    p_a, per_a, more_a = oil_a
    p_b, per_b, more_b = oil_b
    line_a, soft_a, dense_a = hose.hose_contents(state.lack_a, p_a, own)
    line_b, soft_b, dense_b = hose.hose_contents(state.lack_b, p_b, own)
    net_a, net_b, q_p, q_t = rigid_lines(
        y, line_a, line_b, soft_a + per_s, soft_b + per_s, p_s, p_t, plant, rates, counts,
        powers)
    out_a = hose.outward(line_a, soft_a, own.c_out_a, own.k_burst_a)
    out_b = hose.outward(line_b, soft_b, own.c_out_b, own.k_burst_b)
    net_a, net_b = net_a - out_a, net_b - out_b
    gained_a, gained_b = chambers.surpluses(0.0, 0.0, p_a, p_b, v, plant.chambers)
    q_a, rates.lines.lift_a = held_flow(
        line_a, p_a, line_b, state.lift_a, even_flow(net_a, gained_a, soft_a, per_a),
        soft_a + per_a, plant.holding_a, own)
    q_b, rates.lines.lift_b = held_flow(
        line_b, p_b, line_a, state.lift_b, even_flow(net_b, gained_b, soft_b, per_b),
        soft_b + per_b, plant.holding_b, own)
    mass_a = own.density_unit * (1.0 + more_a) * q_a
    mass_b = own.density_unit * (1.0 + more_b) * q_b
    rates.lines.lack_a = mass_a - (1.0 + dense_a) * net_a
    rates.lines.lack_b = mass_b - (1.0 + dense_b) * net_b
    left_a, left_b = mass_a / (1.0 + dense_a), mass_b / (1.0 + dense_b)
    if counts:
        powers.throttling += (line_a * left_a - p_a * q_a) + (line_b * left_b - p_b * q_b)
    stored = line_a * (net_a - left_a) + line_b * (net_b - left_b)
    return q_a, q_b, q_p, q_t, stored, line_a * out_a + line_b * out_b


@kernel
def line_flows(y, oil_a, oil_b, v, p_s, p_t, per_s, plant, rates, counts, powers):
    """Return `hosed_lines`; without hoses `rigid_lines` with nothing stored or lost outside."""
    if plant.hoses.is_on > 0.0:
        return hosed_lines(y, oil_a, oil_b, v, p_s, p_t, per_s, plant, rates, counts, powers)
    p_a, per_a, _ = oil_a
    p_b, per_b, _ = oil_b
    q_a, q_b, q_p, q_t = rigid_lines(
        y, p_a, p_b, per_a + per_s, per_b + per_s, p_s, p_t, plant, rates, counts, powers)
    return q_a, q_b, q_p, q_t, 0.0, 0.0


@kernel
def sensed_pressures(y, plant):
    """Return both pressures at the sensors: of the hoses, or of the chambers, in Pa."""
    p_a, p_b = y.chambers.p_a, y.chambers.p_b
    if plant.hoses.is_on > 0.0:
        p_a, _, _ = hose.hose_contents(y.lines.lack_a, p_a, plant.hoses)
        p_b, _, _ = hose.hose_contents(y.lines.lack_b, p_b, plant.hoses)
    return p_a, p_b


@kernel_function
def rest_lines(plant: np.record, pressures: tuple[float, float], state: np.record) -> None:
    """Put the hoses of a `LINES_STATE` at their pressures (Pa), the poppets where they stay."""
    if not plant.hoses.is_on:
        return
    volume = hose.soft_volume(plant.hoses)
    state.lack_a = lack(pressures[0], 0.0, volume, plant.hoses)
    state.lack_b = lack(pressures[1], 0.0, volume, plant.hoses)
    state.lift_a, state.lift_b = plant.holding_a.is_stuck_open, plant.holding_b.is_stuck_open
