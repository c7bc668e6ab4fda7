"""
The rates of one actuator's plant: the terms of its components, put together.

Signs as in the components' headers: flows are positive INTO a chamber, forces push out.
Position and velocity are read once and handed on: behind the writes of a rate the compiler reads
a state again, which costs a tick 1.5 %.
"""

from isa_ros.core.kernel import kernel
from isa_ros.plant import (
    chambers, coil, cushion, friction, hysteresis, mechanics, relief, return_spring, spool)
from isa_ros.plant.cavitation import contents
from isa_ros.plant.service_lines import line_flows


@kernel
def plant_rates(y, x_load, v_load, drive, p_s, p_t, plant, of_volumes, rates, counts, powers,
                per_s=0.0):
    """
    Write dy/dt of one `PLANT_STATE` into ``rates``; return (sensor force, q_p, q_t).

    ``drive`` is the amplifier's output: a current reference (A), or for an explicit coil a
    voltage (V). ``x_load`` and ``v_load`` are the load's side of the force sensor. Forces
    in N or Nm, flows in m3/s. ``powers``, an `ENERGIES` record, receives where the power goes,
    in W, if it ``counts``  (E2 to E6). A step ``of_volumes`` has the `lack` of the chambers as
    their state. ``per_s`` is the elastance of a supply whose pressure moves, in Pa/m3: it is in
    series with a chamber's where a land smooths its flow (V18).
    """
    s, v = y.mechanics.position, y.mechanics.velocity
    filling = chambers.filling(y.chambers, v, plant.chambers)
    valve_rates(y, drive, p_s, p_t, plant, rates)
    oil_a, oil_b = port_contents(y, s, of_volumes, plant)
    q_a, q_b, q_p, q_t, stored, spilt = line_flows(
        y, oil_a, oil_b, filling * v, p_s, p_t, per_s, plant, rates, counts, powers)
    in_a, in_b = chambers.surpluses(
        q_a, q_b, oil_a[0], oil_b[0], filling * v, plant.chambers)
    in_a, in_b, push, lost, kept, wider_a, wider_b = cushion.pass_spears(
        y.cushion, s, v, (*oil_a, in_a), (*oil_b, in_b), plant, rates.cushion)
    out_a, out_b, vent, returned, push, kept = outlets(
        s, v, p_t, (*oil_a, in_a), (*oil_b, in_b), push, kept, plant)
    chambers.chamber_rates(
        of_volumes, in_a - out_a, in_b - out_b, oil_a, oil_b, v, wider_a, wider_b,
        plant.chambers, rates.chambers)
    f_sensor, f_friction, f_stop = moving_rates(
        s, v, y.friction.bristle, x_load, v_load, oil_a[0], oil_b[0], filling, push, plant, rates)
    if counts:
        count_oil(oil_a[0], oil_b[0], p_t, vent, in_a, in_b, out_a, out_b, lost, kept, plant,
                  powers)
        if plant.hoses.is_on > 0.0:
            powers.cross_port += spilt
            powers.compression += stored
        count_moving(v, v_load, f_sensor, f_friction, f_stop, plant.mechanics, powers)
    return f_sensor, q_p, q_t + out_a + returned


@kernel
def valve_rates(y, drive, p_s, p_t, plant, rates):
    """Write the rates of coil and spool under the amplifier's output  (V1, V2, V12, V24)."""
    coil.coil_rates(y.coil, drive, plant.coil, rates.coil)
    current = coil.coil_current(y.coil, plant.coil) / plant.coil.parallel
    if plant.hysteresis.is_on > 0.0:
        current = hysteresis.magnetised(current, plant.hysteresis)
    current += spool.null_bias(p_s, p_t, plant.spool)
    spool.spool_rates(y.spool, current, plant.valve.k_spool, plant.spool, rates.spool)


@kernel
def port_contents(y, s, of_volumes, plant):
    """
    Return (P, elastance, e - 1) of the oil at both ports  (C2, C11), Pa, Pa/m3, 1.

    e is the density over that at the vapour pressure; in a step of pressures it is not needed,
    and left at 1.
    """
    own = y.chambers
    if of_volumes:
        v_a, v_b = cushion.port_volumes(y.cushion.end, s, plant)
        return (contents(own.cavity_a, v_a, own.p_a, plant.chambers),
                contents(own.cavity_b, v_b, own.p_b, plant.chambers))
    per_a, per_b = chambers.elastances(s, plant.chambers)
    return (own.p_a, per_a, 0.0), (own.p_b, per_b, 0.0)


@kernel
def outlets(s, v, p_t, oil_a, oil_b, push, kept, plant):
    """
    Return what leaves both chambers but through the valve  (C6, C10), or an open B  (C33).

    ``oil_a`` and ``oil_b`` are `port_contents`, and what each gains, m3/s. Returns both flows, the
    pressure behind B, what of B's flow is returned, and force (N) and stored power (W) with those
    of a return spring  (M5).
    """
    p_a, per_a, _, in_a = oil_a
    p_b, per_b, _, in_b = oil_b
    out_a = relief.eased_flow(p_a, p_t, in_a, per_a, plant.relief)
    if plant.spring.is_on > 0.0:
        vent = return_spring.vent_pressure(p_t, plant.spring)
        out_b = return_spring.vented(p_b, vent, in_b, per_b)
        pulled = return_spring.spring_force(s, plant.spring)
        return (out_a, out_b, vent, plant.spring.to_tank * out_b, push - pulled,
                kept + pulled * v)
    out_b = relief.eased_flow(p_b, p_t, in_b, per_b, plant.relief)
    return out_a, out_b, p_t, out_b, push, kept


@kernel
def moving_rates(s, v, z, x_load, v_load, p_a, p_b, filling, push, plant, rates):
    """
    Write the rates of piston and bristles; return the forces of sensor, friction and stop, N.

    I s'' = f_h - f_friction - f_sensor + f_stop  (M4); f_h times the ``filling`` of a motor  (M9),
    with ``push`` of a spear and a return spring. ``z`` is the deflection of the bristles.
    """
    z_rate = friction.bristle_rate(v, z, plant.friction)
    rates.friction.bristle = z_rate
    f_sensor = mechanics.sensor_force(s, v, x_load, v_load, plant.mechanics)
    f_friction = friction.friction_force(v, z, z_rate, plant.friction)
    f_stop = mechanics.stop_force(s, v, plant.chambers.stroke, plant.mechanics)
    rates.mechanics.position = v
    rates.mechanics.velocity = (
        filling * chambers.hydraulic_force(p_a, p_b, plant.chambers) + push - f_friction - f_sensor
        + f_stop
    ) / plant.mechanics.inertia
    return f_sensor, f_friction, f_stop


@kernel
def count_oil(p_a, p_b, p_t, vent, in_a, in_b, out_a, out_b, lost, kept, plant, powers):
    """Write the powers of the chambers  (E3, E6), W; ``lost`` and ``kept`` at and by a spear."""
    powers.throttling += lost
    powers.cross_port = chambers.leakage_loss(p_a, p_b, plant.chambers)
    powers.relief = (p_a - p_t) * out_a + (p_b - vent) * out_b
    powers.compression = p_a * (in_a - out_a) + p_b * (in_b - out_b) + kept


@kernel
def count_moving(v, v_load, f_sensor, f_friction, f_stop, mechanics, powers):
    """Write the powers of friction and damping, and the work on the load  (E4, E5), in W."""
    slip = v - v_load
    powers.friction = f_friction * v
    powers.damping = mechanics.d_s * slip * slip - f_stop * v
    powers.work = f_sensor * v_load
