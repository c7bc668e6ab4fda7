"""Setpoints: JointState messages, their bytes, recorded ones, and those of a user's controller."""

import math
import random
from typing import Any

from isa_ros.actuator.setpoint_range import complete, SetpointRange
from isa_ros.controller import Setpoint
from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, POSITION, SPOOL
from isa_ros.core.record import rows_of
from isa_ros.core.signals import COMMAND, EVERY_KIND, SAMPLE
from isa_ros.requests import fill_requests
from msg_adapters.setpoint import applied_to_command, msg_to_command
import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from tests.fuzz.bytes_of import altered
from tests.fuzz.property import refused
from tests.sheets import actuator_sheet

NAME = 'knee'
NAMES = (NAME, f'{NAME}/stiffness', f'{NAME}/damping', f'{NAME}/enabled', f'{NAME}/mode',
         f'{NAME}/reference', f'{NAME}/changed', f'{NAME}/spool', f'{NAME}/current', 'hip', '',
         '/', 'é', '\x1b[2J', 'x' * 5000)
NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.05, 1e5, 1e308, -1e308, 5e-324, math.nan, math.inf, -math.inf)
ODD: tuple[Any, ...] = (
    *NUMBERS, None, True, '1', [], (), {}, 10**400, np.float32(1.0), np.array([1.0, 2.0]), 1j,
    object)
APPLIED = JointState(
    name=list(NAMES[:7]), position=[0.05, 1e5, 4e3, 1.0, 6.0, 0.0, 3.0], velocity=[0.0] * 7,
    effort=[0.0] * 7)
RANGE = SetpointRange(NAME, actuator_sheet('isa_v5'))
MODES = (None, None, 'force', 'spool', 'speed', '', 5)


def message(dice: random.Random) -> JointState:
    """Return a message with names and numbers of all kinds."""
    names = dice.choices(NAMES, k=dice.randrange(5))
    if dice.random() < 0.7:
        names = list(NAMES[:dice.randrange(1, 4)])
    sizes = [len(names) if dice.random() < 0.7 else dice.randrange(6) for _ in range(3)]
    values = [dice.choices(NUMBERS if dice.random() < 0.4 else NUMBERS[:6], k=n) for n in sizes]
    return JointState(name=names, position=values[0], velocity=values[1], effort=values[2])


def controlled(dice: random.Random) -> Any:
    """Return what a user's controller might return."""
    if dice.random() < 0.05:
        return dice.choice(ODD)
    values = [dice.choice(ODD if dice.random() < 0.2 else NUMBERS[:6]) for _ in range(6)]
    setpoint: Any = Setpoint(
        *values[:5], is_enabled=dice.choice((None, True, False, values[5])),
        mode=dice.choice(MODES), spool=dice.choice((None, None, None, values[5])),
        quick_stop=dice.choice((False, False, True, values[4])))
    if dice.random() < 0.1:
        setpoint = dice.choice((*ODD, values, tuple(values[:3])))
    return {dice.choice((NAME, NAME, NAME, 'hip', 5, None, 'x' * 5000)): setpoint}


def _taken(found: JointState, dice: random.Random) -> None:
    """Take a message as a node does: numbers that its mode does not use may be missing."""
    command = msg_to_command(found, NAME)
    RANGE.admit(command, dice.choice((CURRENT, SPOOL, FORCE, POSITION, IMPEDANCE)))
    complete(command, 0.05)
    assert_valid(command)


def _of_message(dice: random.Random) -> None:
    _taken(message(dice), dice)


def _of_bytes(dice: random.Random) -> None:
    try:
        found = deserialize_message(altered(serialize_message(message(dice)), dice), JointState)
    except (_rclpy.RCLError, _rclpy.RMWError):
        return  # `DirectServer` discards it
    _taken(found, dice)


def _of_bag(dice: random.Random) -> None:
    assert_valid(applied_to_command(altered(serialize_message(APPLIED), dice), NAME))


def _of_controller(dice: random.Random) -> None:
    requests, sample = np.zeros(1, COMMAND), rows_of(1, SAMPLE)[0]
    sample.device_mode = dice.choice((CURRENT, SPOOL, FORCE, POSITION, IMPEDANCE))
    fill_requests(controlled(dice), [NAME], requests, {NAME: sample})
    if requests[0]['kinds']:
        assert_valid(requests[0])


DOORS = (_of_message, _of_message, _of_bytes, _of_bag, _of_controller)


def assert_valid(command: np.void) -> None:
    """Assert that a command has finite numbers, and gains that are NaN or >= 0."""
    assert 0 <= command['kinds'] <= EVERY_KIND and command['is_enabled'] in (0, 1), command
    assert 0 <= command['mode'] <= 6 and math.isfinite(command['reference']), command
    assert all(math.isfinite(command[name]) for name in ('position', 'velocity', 'effort'))
    assert not any(command[gain] < 0.0 or math.isinf(command[gain])
                   for gain in ('stiffness', 'damping')), command


def fuzz(cases: int, seed: int) -> int:
    """Hand over that many setpoints; return how many were refused."""
    dice = random.Random(seed)
    n_refused = 0
    for k in range(cases):
        door = dice.choice(DOORS)
        n_refused += refused(lambda: door(dice), f'case {k} of seed {seed}, {door.__name__}')
    return n_refused
