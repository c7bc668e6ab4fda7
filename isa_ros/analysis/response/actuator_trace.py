"""
The signals of one actuator whose setpoint follows an array: exact states and all references.

A tick is as short as the period of the converters, so that there is a row for each of them.
"""

from collections.abc import Mapping

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.states import STATES
from isa_ros.actuator.timing import Timing
from isa_ros.core.signals import COMMAND, HAS_SETPOINT, Records
from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np

PERIOD_NS = 100_000   # that of the converters and of the current loop
RATE_HZ = NS_PER_SECOND / PERIOD_NS
TIMING = Timing(PERIOD_NS, 0)

Trace = Mapping[str, np.ndarray]
"""
The fields of `STATES` over time, (n,) each.

Row k holds the exact states of one instant and the references made then: error and reference
of one row belong together.
"""

_REFERENCES = {name for name in STATES.names or () if name.endswith('_reference')} | {'drive'}


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


def traced(group: ActuatorGroup, ports: Records, commands: Records) -> Trace:
    """
    Advance one actuator with `TIMING` by a tick for each of ``commands``; return its trace.

    Raises
    ------
    SimulationDiverged
        A state is no longer finite.

    """
    states = group.advance_many(ports, commands, with_samples=False).states[:, 0]
    return {name: states[1:][name] if name in _REFERENCES else states[:-1][name]
            for name in STATES.names or ()}
