"""Setpoints of all kinds to a running actuator: a defined state, and one line at most."""

import math
import random

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.device import FIELDS, MODES, STATES
from isa_ros.errors import SetpointError
from isa_ros.reu.wiring import possible_modes
from msg_adapters.setpoint import msg_to_command
import numpy as np
from sensor_msgs.msg import JointState
from tests.fuzz import setpoint_door
from tests.fuzz.property import Broken

REFERENCES = ('current', 'spool', 'pressure')
WITHIN = {'current': 0.01, 'spool': 1e-4, 'pressure': 5e6}    # A, m, Pa
BURST = 100     # setpoints between two ticks: 100,000 a second
PER_TICK = 3    # cases between two ticks, on average
NUMBERS = (*setpoint_door.NUMBERS, 0.03, 0.06, -1e-9, 1e-4, 1e-3, 3e6)


def setpoint(dice: random.Random, name: str) -> JointState:
    """Return a setpoint within the range, of a mode, huge, of wrong names or lengths."""
    kind = dice.random()
    if kind < 0.3:
        return JointState(name=[name], position=[dice.uniform(0.02, 0.08)],
                          effort=[dice.uniform(-500.0, 500.0)])
    if kind < 0.5:
        entry = dice.choice(REFERENCES)
        size = dice.choice((1.0, 1.0, 1e3, math.nan, math.inf)) * WITHIN[entry]
        return JointState(name=[f'{name}/{entry}'], position=[dice.uniform(-1.0, 1.0) * size])
    if kind < 0.75:
        entries = [name, *(f'{name}/{entry}' for entry in ('stiffness', 'damping', *REFERENCES))]
        names = dice.sample(entries, dice.randrange(1, 4))
        return JointState(name=names, position=dice.choices(NUMBERS, k=len(names)))
    if kind < 0.77:
        return JointState(name=[name] * 10_000, position=[1e300] * 10_000)
    return setpoint_door.message(dice)


def handed_over(message: JointState, actuator: SmartActuator) -> str:
    """Return the line about a setpoint, as a node writes it, '' for none; accept it if valid."""
    try:
        return actuator.admit(msg_to_command(message, actuator.name))
    except SetpointError as error:
        return str(error)


def assert_defined(actuator: SmartActuator) -> None:
    """Assert that state and mode are ones of the device, and all that it reports is finite."""
    sample = actuator.sample
    mode, state = int(sample.device_mode), int(sample.device_state)
    if not (state in range(len(STATES)) and mode in possible_modes(actuator.sheet.reu)):
        raise Broken(f'state {state}, mode {MODES[mode]}')
    values = np.array([float(sample[field]) for field in sample.dtype.names or () if field])
    if not np.isfinite(values).all() or not set(FIELDS) <= set(sample.dtype.names or ()):
        raise Broken(f'a sample with {values}')


def fuzz(actuator: SmartActuator, cases: int, seed: int) -> int:
    """Hand over that many setpoints, in bursts between ticks; return how many lines there were."""
    dice, lines = random.Random(seed), 0
    modes = [MODES[mode] for mode in possible_modes(actuator.sheet.reu)]
    done = 0
    while done < cases:
        if dice.random() < 0.05:
            actuator.change_mode(dice.choice(modes))
        for _ in range(BURST if dice.random() < 0.01 else dice.randrange(1, 2 * PER_TICK)):
            message = setpoint(dice, actuator.name)
            before = actuator.memory.pending.tobytes()
            line = handed_over(message, actuator)
            if '\n' in line or len(line) > 2000:
                raise Broken(f'case {done} of seed {seed}: {line[:200]!r}')
            refused = line and 'limited to' not in line
            if refused and actuator.memory.pending.tobytes() != before:
                raise Broken(f'case {done} of seed {seed}: refused and accepted: {line}')
            lines += bool(line)
            done += 1
        actuator.tick()
        assert_defined(actuator)
    return lines
