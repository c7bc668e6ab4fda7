"""
One tick of one actuator: the REU's instants and the plant's steps in time order.

Composes plant, REU and load copy (`integration`) into one kernel.
"""

import math

from isa_ros.actuator.energy import add_energies, add_tare, stored_elastically, take_heat
from isa_ros.actuator.feed import write_feed
from isa_ros.actuator.frames import leaves
from isa_ros.actuator.inbox import latch, lose_pending, merge, settle
from isa_ros.actuator.integration import (
    COPIES, end_steps, Integrated, rk4_step, simpson, STAGES, STATE_SIZE, TOTALS_AT)
from isa_ros.actuator.link import exchange_frames, hand_over, LINK, receive_samples, send_sample
from isa_ros.core.kernel import kernel, part_of_kernel
from isa_ros.core.timebase import FORCE_WINDOWS, PLANT_STEP
from isa_ros.loads.forces import OWN_LOAD
from isa_ros.plant.block_valve import drive_block
from isa_ros.plant.coil import coil_heat
from isa_ros.plant.hysteresis import copy_plays
from isa_ros.plant.plant import exact_force, PLANT
from isa_ros.plant.sensors import sense
from isa_ros.plant.temperature_sensor import read_temperature
from isa_ros.plant.thermal import warm
from isa_ros.reu.cascade import cascade_step, is_due, REU
from isa_ros.reu.device import write_device
from isa_ros.reu.protection import write_trips
from isa_ros.reu.reactions import protect, setpoint_in_force
from isa_ros.reu.watchdog import stand_still
import numpy as np

ACTUATOR = np.dtype([
    ('plant', PLANT), ('reu', REU), ('load', OWN_LOAD), ('link', LINK), ('noise_key', 'u8'),
    ('link_key', 'u8')])
"""Every constant of one actuator, SI."""


@kernel
def write_sample(plant, reu, sample):
    """Fill one `SAMPLE` from sensor readings and references of the REU, and exact states."""
    measured = reu.measured
    sample.position = measured.position
    sample.velocity = reu.speed.velocity
    sample.force = measured.force
    sample.pressure_a = measured.pressure_a
    sample.pressure_b = measured.pressure_b
    sample.spool = measured.spool
    sample.spool_velocity = plant.spool.velocity
    sample.current = measured.current
    sample.position_reference = setpoint_in_force(reu).position
    sample.force_reference = reu.force_reference
    sample.spool_reference = reu.spool_reference
    sample.current_reference = reu.current_reference
    oil = plant.chambers
    sample.chamber_pressure_a, sample.chamber_pressure_b = oil.p_a, oil.p_b
    sample.cavity_a, sample.cavity_b = oil.cavity_a, oil.cavity_b
    sample.cushion_pressure = plant.cushion.p
    write_trips(reu.protection, sample)
    write_device(reu.status, sample)


@part_of_kernel
def run_loops(step, state, actuator, reu_state, channels, thermal):
    """Run the loops that are due at plant step ``step`` on a `CONTINUOUS`."""
    reu = actuator.reu
    if is_due(step, reu.current_steps, reu.offset_steps):
        if reu.is_frozen == 0.0:
            reu_state.supply_pressure = sense(
                step, reu.current_steps, state.plant, state.load.position, state.load.velocity,
                state.supply.pressure, actuator.plant, actuator.noise_key, channels,
                reu_state.measured)
            if reu.protection.is_on:
                protect(step, reu_state.supply_pressure, thermal.sensed, reu.protection,
                        reu_state)
            else:
                reu_state.frozen_for = 0.0
            cascade_step(step, reu, reu_state)
        else:
            stand_still(step, reu.current_steps * PLANT_STEP, reu, reu_state)
    if step == actuator.load.rope.release_step:
        state.load.weight.is_released = 1.0
    if is_due(step, reu.current_steps, reu.offset_steps + reu.delay_steps):
        reu_state.amplifier = reu_state.drive
    if actuator.plant.block.is_on > 0.0:
        device = reu_state.status
        drive_block(device.is_energised, (step - device.switched) * PLANT_STEP,
                    state.plant.block.lift, actuator.plant.block)


@part_of_kernel
def loops_and_plant(step, tau, weight, own, reu_state, channels, thermal):
    """Run the loops that are due at plant step ``step``, then the plant over that step."""
    state, plant = own.continuous[0], own.actuator.plant
    run_loops(step, state, own.actuator, reu_state, channels, thermal)
    rk4_step(PLANT_STEP, tau, reu_state.amplifier, weight, own)
    if plant.thermal.is_on:
        thermal.coil += PLANT_STEP * coil_heat(state.plant.coil, plant.coil)


@kernel
def first_broken(y):
    """Return the index of the first state that is not finite, or -1."""
    for j in range(STATE_SIZE):
        if not math.isfinite(y[0, j]):
            return j
    return -1


@kernel
def take_port(incoming, is_shared, port, state):
    """
    Copy the coordinator's `LOAD_PORT` of this tick.

    A shared load's state overwrites the load copy; of an actuator with its own load only the
    pressures are copied.
    """
    port.supply_pressure = state.supply.pressure = incoming.supply_pressure
    port.return_pressure = incoming.return_pressure
    if is_shared:
        port.x0, port.v0, port.a0 = incoming.x0, incoming.v0, incoming.a0
        port.inverse_mass = incoming.inverse_mass
        port.a_bias, port.jerk = incoming.a_bias, incoming.jerk
        port.stiffness, port.damping = incoming.stiffness, incoming.damping
        state.load.position = port.x0
        state.load.velocity = port.v0


@part_of_kernel
def tick_row(first_step, steps, n, own, link, memory):
    """
    Advance the actuator of row ``n`` by ``steps`` plant steps; ``own`` is its `Integrated`.

    Fills its `LOAD_REPLY` (mean force of each of the tick's windows from its impulse), its
    `SAMPLE` at the end of the tick and, of a supply with a port, its `SUPPLY_REPLY`. ``link`` is
    its row where it has a link, else -1.
    """
    port, feed, actuator, state = own.port, own.feed, own.actuator, own.continuous[0]
    reu_state, channels, thermal = memory.reu[n], memory.channels[n], memory.thermals[n]
    reply, fed, sample = memory.replies[n], memory.fed[n], memory.samples[n]
    plays = memory.plays[n]
    if actuator.plant.thermal.is_on:
        warm(thermal.oil, actuator.plant)
    if actuator.plant.hysteresis.is_on > 0.0:
        copy_plays(plays, actuator.plant.hysteresis.plays)
    own.y[0, TOTALS_AT:] = 0.0
    elastic = stored_elastically(state, actuator.plant.mechanics)
    window_steps = steps // FORCE_WINDOWS
    for window in range(FORCE_WINDOWS):
        state.totals.impulse = 0.0
        for i in range(window * window_steps, (window + 1) * window_steps):
            if link >= 0:
                is_sampled = i > 0 and leaves(first_step + i, actuator.link)
                if is_sampled:
                    write_sample(state.plant, reu_state, sample)
                exchange_frames(first_step + i, is_sampled, link, memory)
            loops_and_plant(first_step + i, i * PLANT_STEP, PLANT_STEP * simpson(i, steps), own,
                            reu_state, channels, thermal)
        reply.mean_forces[window] = state.totals.impulse / (window_steps * PLANT_STEP)
    slope = end_steps(
        steps * PLANT_STEP, PLANT_STEP * simpson(steps, steps), reu_state.amplifier, own)
    if actuator.plant.hysteresis.is_on > 0.0:
        copy_plays(actuator.plant.hysteresis.plays, plays)
    if feed.elastance > 0.0:
        write_feed(own.rates[0].totals.supply_volume, slope, state.totals.energies.drawn, fed)
    else:
        add_tare(steps * PLANT_STEP, port, actuator.plant.valve, state.totals)
    reply.force = exact_force(
        state.plant, state.load.position, state.load.velocity, actuator.plant)
    reply.position = state.plant.mechanics.position
    reply.velocity = state.plant.mechanics.velocity
    reply.supply_volume = state.totals.supply_volume
    reply.return_volume = state.totals.return_volume
    write_sample(state.plant, reu_state, sample)
    sample.supply_volume += reply.supply_volume
    sample.return_volume += reply.return_volume
    sample.largest_cavity = max(sample.largest_cavity, sample.cavity_a, sample.cavity_b)
    sample.supply_flow = reply.supply_volume / (steps * PLANT_STEP)
    if actuator.reu.is_frozen == 0.0:   # else its last reading stays
        sample.supply_pressure = (state.supply.pressure if actuator.plant.sensors.errors.are_ideal
                                  else reu_state.supply_pressure)
    add_energies(reply, port, feed, state.totals.energies,
                 stored_elastically(state, actuator.plant.mechanics) - elastic,
                 steps * PLANT_STEP, sample)
    if actuator.plant.thermal.is_on:
        carried = take_heat(steps * PLANT_STEP, reply, feed, state.totals.energies,
                            actuator.plant.thermal, thermal)
        if feed.is_warm > 0.0:
            fed.heat = carried
    if actuator.reu.is_frozen == 0.0:
        thermal.sensed = read_temperature(
            first_step + steps, thermal.oil, actuator.noise_key,
            actuator.plant.sensors.temperature, thermal.sensed)
    sample.temperature, sample.age = thermal.sensed, reu_state.frozen_for
    sample.is_stale = 1.0 if reu_state.frozen_for > 0.0 else 0.0
    if link >= 0:
        send_sample(first_step + steps, link, memory)


@part_of_kernel
def actuator_tick(first_step, steps, incoming, commands, memory):
    """
    Advance every actuator by ``steps`` plant steps, one after the other.

    Return the place of the first state that is no longer finite in the states of all, or -1.
    ``incoming`` are this tick's `LOAD_PORT` rows and ``commands`` the `COMMAND` rows that take
    effect at its start, (n,) each; ``memory`` is a `Memory` of n actuators.
    """
    for n in range(len(memory.ports)):
        own = Integrated(
            memory.ports[n], memory.feeds[n], memory.constants[n],
            memory.continuous[n * COPIES:(n + 1) * COPIES],
            memory.rates[n * STAGES:(n + 1) * STAGES],
            memory.states[n * COPIES:(n + 1) * COPIES],
            memory.slopes[n * STAGES:(n + 1) * STAGES])
        reu = memory.reu[n]
        link = n if memory.constants[n].link.is_on else -1
        merge(commands[n], memory.pending[n])
        if link < 0 and memory.constants[n].reu.is_frozen:
            lose_pending(memory.pending[n], memory.applied[n])
        elif link < 0:
            latch(memory.pending[n], reu, memory.applied[n])
        else:
            hand_over(first_step, n, memory)
        take_port(incoming[n], memory.is_shared[n], own.port, own.continuous[0])
        tick_row(first_step, steps, n, own, link, memory)
        settle(reu.status, memory.applied[n])
        if link < 0:
            memory.observed[n] = memory.samples[n]
        else:
            receive_samples(first_step + steps, n, memory)
        broken = first_broken(own.y)
        if broken >= 0:
            return n * STATE_SIZE + broken
    return -1
