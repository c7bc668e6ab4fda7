"""
The signals of one actuator whose setpoint follows an array: exact states and all references.

A tick is as short as the period of the converters, so that there is a row for each of them.
"""

from isa_ros.actuator.actuator import Timing
from isa_ros.actuator.group import ActuatorGroup, Records
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np

PERIOD_NS = 100_000   # that of the converters and of the current loop
RATE_HZ = NS_PER_SECOND / PERIOD_NS
TIMING = Timing(PERIOD_NS, 0)

_STATES = ('position', 'velocity', 'force', 'pressure_a', 'pressure_b', 'spool', 'current')
_REFERENCES = (
    'position_reference', 'force_reference', 'pressure_reference', 'spool_reference',
    'current_reference', 'drive')

TRACE = np.dtype([
    ('position_reference', 'f8'),   # m | rad
    ('force_reference', 'f8'),      # N | Nm
    ('pressure_reference', 'f8'),   # of the difference, Pa
    ('spool_reference', 'f8'),      # m
    ('current_reference', 'f8'),    # amplifier A
    ('drive', 'f8'),                # to the amplifier: V with an explicit coil, else A
    ('position', 'f8'), ('force', 'f8'), ('pressure', 'f8'), ('spool', 'f8'), ('current', 'f8'),
    ('position_measured', 'f8'), ('force_measured', 'f8'),
    ('velocity', 'f8'),             # exact, m/s | rad/s
    ('pressure_a', 'f8'), ('pressure_b', 'f8'),     # Pa gauge
])
"""One instant: exact states, what the sensors gave then, and the references made from that."""


def setpoints(
        group: ActuatorGroup, quantity: str, values: np.ndarray,
        velocities: np.ndarray | None = None) -> Records:
    """
    Return `COMMAND` rows, (n, 1), for setpoints of position or effort, (n,); gains stay.

    ``velocities`` go with positions, None: all zero. The position stays where only the effort
    is given.
    """
    commands = np.zeros((len(values), 1), COMMAND)
    commands['kinds'] = HAS_SETPOINT
    commands['stiffness'] = commands['damping'] = np.nan
    commands['position'] = group.samples['position_reference']
    if quantity == 'position' and velocities is not None:
        commands['velocity'][:, 0] = velocities
    commands[quantity][:, 0] = values
    return commands


def traced(group: ActuatorGroup, ports: Records, commands: Records) -> np.ndarray:
    """
    Advance one actuator with `TIMING` by a tick for each of ``commands``; return its `TRACE`.

    States are those before the loops run at an instant, references those after: error and
    reference of one row belong together.

    Raises
    ------
    SimulationDiverged
        A state is no longer finite.

    """
    log = group.advance_many(ports, commands)
    samples, before, after = log.samples[:-1, 0], log.states[:-1, 0], log.states[1:, 0]
    trace = np.zeros(len(commands), TRACE)
    for name in _STATES:
        trace[name] = before[name]
    for name in _REFERENCES:
        trace[name] = after[name]
    trace['pressure'] = before['pressure_a'] - before['pressure_b']
    for name in ('position', 'force'):
        trace[f'{name}_measured'] = samples[name]
    return trace
