"""
Names of the states, modes and events of an actuator's device, and their numbers.

A number is the place of a name in its list; `SAMPLE` and `COMMAND` hold numbers. What they do is
in `isa_ros.reu.device`.
"""

from isa_ros.core.kernel import kernel_function
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP_NS

STATES = ('initialising', 'disabled', 'enabled', 'quick stop', 'fault reaction', 'fault')
INITIALISING, DISABLED, ENABLED, QUICK_STOP, FAULT_REACTION, FAULT = range(6)

MODES = ('none', 'current', 'spool', 'pressure', 'force', 'position', 'impedance')
NO_MODE, CURRENT, SPOOL, PRESSURE, FORCE, POSITION, IMPEDANCE = range(7)
"""A mode is named after its outermost block; the blocks inside of it run too."""

REFERENCES = {'current': CURRENT, 'spool': SPOOL, 'pressure': PRESSURE}
"""The modes whose setpoint is one number: amplifier A, m of spool, Pa of pressure difference."""

EVENTS = ('start', 'ready', 'trip', 'clear fault', 'mode', 'enable', 'disable', 'quick stop',
          'stop ends', 'reaction ends', 'emergency stop')
(START, READY, TRIP, CLEAR, MODE, ENABLE, DISABLE, STOP, STOP_ENDS, REACTION_ENDS,
 EMERGENCY_STOP) = range(11)

FIELDS = ('device_state', 'device_mode', 'device_event', 'warnings', 'trips', 'state_since',
          'first_trip', 'last_trip', 'trip_time', 'trip_value', 'trip_level', 'warning_time',
          'unused_setpoints', 'refused_requests', 'age', 'is_stale', 'frames_lost_down',
          'frames_lost_up', 'commands_dropped')
"""Fields of a `SAMPLE` that describe the device."""


_HALF_STEP_NS = 0.5 * PLANT_STEP_NS


@kernel_function
def is_status_due(
        since: float, age: float, is_stale: float, t_ns: int, tick_start_ns: int) -> bool:
    """
    Return whether a tick that ends at ``t_ns`` has a message of a device, by its `SAMPLE`.

    It is one in which the status has changed, as far as it has arrived over a link, or a second
    of simulated time ended; t = 0. ``since`` and ``age`` are ``state_since`` and the age, s.
    """
    arrived = since + (0.0 if is_stale else age)
    return (arrived * NS_PER_SECOND > tick_start_ns - _HALF_STEP_NS
            or t_ns // NS_PER_SECOND != tick_start_ns // NS_PER_SECOND or t_ns == 0)


def mode_name(number: float) -> str:
    """Return the name of a mode by its number."""
    return MODES[int(number)]


def state_name(number: float) -> str:
    """Return the name of a state by its number."""
    return STATES[int(number)]


def event_name(number: float) -> str:
    """Return the name of an event by its number."""
    return EVENTS[int(number)]
