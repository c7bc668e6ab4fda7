"""Memory of the actuators of one process: a row each, so that one kernel call advances all."""

from typing import NamedTuple

from isa_ros.actuator.frames import SLOTS
from isa_ros.actuator.integration import flat, scratch
from isa_ros.actuator.kernel import ACTUATOR
from isa_ros.actuator.link import LINK_STATE
from isa_ros.core.signals import (
    COMMAND, LOAD_PORT, LOAD_REPLY, SAMPLE, SUPPLY_PORT, SUPPLY_REPLY)
from isa_ros.plant.channels import CHANNELS_STATE
from isa_ros.plant.hysteresis import PLAYS
from isa_ros.plant.thermal import THERMAL_STATE
from isa_ros.reu.cascade import REU_STATE
import numpy as np


class Memory(NamedTuple):
    """
    Memory that the tick kernel reads and writes, for ``n`` actuators.

    One row per actuator, except `integration.COPIES` of ``continuous``, `integration.STAGES` of
    ``rates`` and `SLOTS` of the frames on a link.
    """

    is_shared: np.ndarray
    """Whether the actuator moves a body together with others, (n,)."""
    ports: np.ndarray
    """`LOAD_PORT` in force, (n,)."""
    constants: np.ndarray
    """`ACTUATOR`, (n,)."""
    continuous: np.ndarray
    """`CONTINUOUS`: the state and a stage of its integration."""
    rates: np.ndarray
    """`CONTINUOUS`: the stages' rates of change."""
    states: np.ndarray
    """The same memory as ``continuous``, as floats."""
    slopes: np.ndarray
    """The same memory as ``rates``, as floats."""
    reu: np.ndarray
    """`REU_STATE`, (n,)."""
    channels: np.ndarray
    """`CHANNELS_STATE` of the sensors, (n,)."""
    replies: np.ndarray
    """`LOAD_REPLY` of the last tick, (n,)."""
    samples: np.ndarray
    """`SAMPLE` at the end of the last tick, (n,)."""
    pending: np.ndarray
    """`COMMAND` pending for the next tick, (n,)."""
    applied: np.ndarray
    """`COMMAND` that took effect in the last tick, at its start or from its link, (n,)."""
    thermals: np.ndarray
    """`THERMAL_STATE`, (n,)."""
    plays: np.ndarray
    """`PLAYS` of the valve's hysteresis at the end of the last tick, (n,)."""
    links: np.ndarray
    """`LINK_STATE`, (n,)."""
    sent: np.ndarray
    """`COMMAND` handed to the link at the start of the last tick, (n,)."""
    outbox: np.ndarray
    """`COMMAND` that no frame has brought to the REU yet, (n,)."""
    commands_sent: np.ndarray
    """`COMMAND` in frames on their way to the REU."""
    samples_sent: np.ndarray
    """`SAMPLE` in frames on their way to the listeners."""
    observed: np.ndarray
    """`SAMPLE` that the listeners have at the end of the last tick, (n,)."""
    feeds: np.ndarray
    """`SUPPLY_PORT` of the tick, (n,)."""
    fed: np.ndarray
    """`SUPPLY_REPLY` of the last tick, (n,)."""


def memory_of(n: int) -> Memory:
    """Return the memory of ``n`` actuators, all zero."""
    continuous, rates = scratch(n)
    return Memory(
        is_shared=np.zeros(n, np.bool_), ports=np.zeros(n, LOAD_PORT),
        constants=np.zeros(n, ACTUATOR), continuous=continuous, rates=rates,
        states=flat(continuous), slopes=flat(rates), reu=np.zeros(n, REU_STATE),
        channels=np.zeros(n, CHANNELS_STATE), replies=np.zeros(n, LOAD_REPLY),
        samples=np.zeros(n, SAMPLE), pending=np.zeros(n, COMMAND), applied=np.zeros(n, COMMAND),
        thermals=np.zeros(n, THERMAL_STATE), plays=np.zeros(n, PLAYS),
        links=np.zeros(n, LINK_STATE), sent=np.zeros(n, COMMAND), outbox=np.zeros(n, COMMAND),
        commands_sent=np.zeros(n * SLOTS, COMMAND), samples_sent=np.zeros(n * SLOTS, SAMPLE),
        observed=np.zeros(n, SAMPLE), feeds=np.zeros(n, SUPPLY_PORT),
        fed=np.zeros(n, SUPPLY_REPLY))


def row_of(memory: Memory, row: int) -> Memory:
    """Return the memory of one actuator: views on its rows."""
    n = len(memory.ports)
    return Memory(*(
        rows[row * (len(rows) // n):(row + 1) * (len(rows) // n)] for rows in memory))
