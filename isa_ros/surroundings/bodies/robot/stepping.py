"""A robot's part of a tick, bound to its memory: before its actuators, and after them."""

from typing import NamedTuple

from isa_ros.core.kernel import kernel, part_of_kernel
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.surroundings.bodies.robot.kept_forces import kept_part
from isa_ros.surroundings.bodies.robot.motion import tree_of
from isa_ros.surroundings.bodies.robot.port_kernel import (
    motion_part, robot_instant, robot_ports, robot_tick)
from isa_ros.surroundings.bodies.robot.records import RobotRecords
from isa_ros.surroundings.bodies.robot.sampling import fill_sample, read_unit
from isa_ros.surroundings.clock import is_released
import numpy as np


class RobotPorts(NamedTuple):
    """Memory of `fill_ports`."""

    clock: np.ndarray
    """`CLOCK`, (1,)."""
    state: np.ndarray
    """Floats."""
    rows: np.ndarray
    """Of its actuators, (k,)."""
    records: RobotRecords
    ports: np.ndarray
    """`LOAD_PORT` of all actuators."""


class RobotTick(NamedTuple):
    """Memory of `advance` and `show`."""

    clock: np.ndarray
    """`CLOCK`, (1,)."""
    state: np.ndarray
    """Floats."""
    rows: np.ndarray
    """Of its actuators, (k,)."""
    records: RobotRecords
    replies: np.ndarray
    """`LOAD_REPLY` of all actuators."""
    values: np.ndarray
    """The sample as floats."""
    units: np.ndarray
    """`UNIT`, (u,)."""
    periods: np.ndarray
    """Of their readings, ns, int64, (u,)."""
    readings: np.ndarray
    """Of the units, (u, 6); part of the sample."""
    ends: np.ndarray
    """Places in the sample that are 1 when a contact ends the run, int64."""


@part_of_kernel
def fill_ports(own):
    """Release the robot if it is time, and fill its ports for the next tick; return 0."""
    if is_released(own.clock[0]):
        own.state[-1] = 0.0
    robot_ports(own.state, own.clock[0].step, own.rows, own.records, own.ports)
    return 0


@kernel
def take(y, forces, own):
    """Fill the sample, and read the units that are due, under the sensor forces of now."""
    fill_sample(y, forces, own.records, own.values)
    clock = own.clock[0]
    for k in range(len(own.units)):
        if clock.t_ns % own.periods[k] == 0:
            read_unit(
                clock.t_ns // PLANT_STEP_NS, y, own.records, own.units[k], own.readings[k])


@kernel
def show(own):
    """Fill scratch and sample under the forces that the ports assume now; return 0."""
    forces = kept_part(own.state, len(own.rows)).force
    robot_instant(own.state, forces, own.records)
    take(motion_part(own.state, len(own.rows)), forces, own)
    return 0


@part_of_kernel
def advance(own):
    """
    Advance by one tick.

    Return 1 + the place of the first state that is not finite, -1 - the place in ``ends`` of a
    contact that ends the run, or 0.
    """
    clock, k = own.clock[0], len(own.rows)
    broken = robot_tick(own.state, clock.step_ns, own.rows, own.records, own.replies)
    clock.t_ns += clock.step_ns
    if broken >= 0:
        return 1 + broken
    y = motion_part(own.state, k)
    take(y, tree_of(own.records, len(y)).forces, own)
    for n in range(len(own.ends)):
        if own.values[own.ends[n]] != 0.0:
            return -1 - n
    return 0
