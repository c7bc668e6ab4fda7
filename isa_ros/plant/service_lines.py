"""
From the servo valve to the two chambers: what flows, and what the way costs.

Flows are positive INTO a chamber, ``q_p`` OUT OF the supply, ``q_t`` INTO the return.
"""

from isa_ros.core.kernel import kernel
from isa_ros.plant import block_valve, servo_valve


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
