"""A leg's part of a tick, bound to its memory: before its actuators, and after them."""

from typing import NamedTuple

from isa_ros.core.kernel import kernel, part_of_kernel
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.surroundings.bodies.leg.inertial import read_imu
from isa_ros.surroundings.bodies.leg.motion import continuous
from isa_ros.surroundings.bodies.leg.port_kernel import fill_sample, leg_ports, leg_tick
from isa_ros.surroundings.clock import is_released
import numpy as np


class LegPorts(NamedTuple):
    """Memory of `fill_ports`."""

    clock: np.ndarray
    """`CLOCK`, (1,)."""
    states: np.ndarray
    """`LEG_STATE`, (1,)."""
    legs: np.ndarray
    """`LEG`, (1,)."""
    rows: np.ndarray
    """Of its actuators, (3,)."""
    ports: np.ndarray
    """`LOAD_PORT` of all actuators."""


class LegTick(NamedTuple):
    """Memory of `advance` and `show`."""

    clock: np.ndarray
    """`CLOCK`, (1,)."""
    states: np.ndarray
    """`LEG_STATE`, (1,)."""
    legs: np.ndarray
    """`LEG`, (1,)."""
    rows: np.ndarray
    """Of its actuators, (3,)."""
    replies: np.ndarray
    """`LOAD_REPLY` of all actuators."""
    samples: np.ndarray
    """`LEG_SAMPLE`, (1,)."""
    imus: np.ndarray
    """`IMU`, (u,)."""
    periods: np.ndarray
    """Of their readings, ns, int64, (u,)."""
    readings: np.ndarray
    """Of the units, (u, 6)."""


@part_of_kernel
def fill_ports(own):
    """Release the leg if it is time, and fill its ports for the next tick; return 0."""
    if is_released(own.clock[0]):
        own.states[0].is_held = 0.0
    leg_ports(own.states, own.clock[0].step, own.rows, own.legs, own.ports)
    return 0


@kernel
def read_units(forces, own):
    """Read the inertial units that are due under the sensor forces (N | Nm) of now."""
    clock = own.clock[0]
    for k in range(len(own.imus)):
        if clock.t_ns % own.periods[k] == 0:
            read_imu(clock.t_ns // PLANT_STEP_NS, own.states, forces, own.legs, own.imus[k],
                     own.readings[k])


@kernel
def show(own):
    """Fill the sample under the forces that the ports assume now; return 0."""
    state = own.states[0]
    forces = (state.force[0], state.force[1], state.force[2])
    fill_sample(continuous(state), forces, state.is_held != 0.0, own.legs[0], own.samples[0])
    read_units(forces, own)
    return 0


@part_of_kernel
def advance(own):
    """Advance by one tick; return 1 + the place of the first state that is not finite, or 0."""
    clock, rows = own.clock[0], own.rows
    broken = leg_tick(
        own.states, clock.step_ns, rows, own.legs, own.replies, own.samples)
    clock.t_ns += clock.step_ns
    if broken < 0 and len(own.imus) > 0:
        read_units((own.replies[rows[0]].force, own.replies[rows[1]].force,
                    own.replies[rows[2]].force), own)
    return 1 + broken
