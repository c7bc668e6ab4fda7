"""The tables of docs/device.md, from the data that the kernels use."""

from collections.abc import Mapping

from isa_ros.core.device import EVENTS, MODES, STATES
from isa_ros.reu.device import TRANSITIONS
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown

EVENT_WORDS: Mapping[str, str] = {
    'start': 'start of the run',
    'ready': '`initialisation_ms` are over',
    'trip': 'a condition trips whose reaction is quick stop or disable',
    'clear fault': '`~/clear_fault`',
    'mode': 'parameter `mode`',
    'enable': '`~/enable` with true',
    'disable': '`~/enable` with false',
    'quick stop': '`~/quick_stop`',
    'stop ends': 'the reference was at rest for `quick_stop_hold_ms`',
    'reaction ends': 'the same, or at once if the reaction is disable'}
"""What causes each event of `isa_ros.core.device.EVENTS`."""

_BLOCKS = {
    'current': 'current', 'spool': 'spool, current', 'pressure': 'pressure, spool, current',
    'force': 'force, then as pressure or spool', 'position': 'position (pid), then as force',
    'impedance': 'position (impedance), force, then as pressure or spool'}
_SETPOINTS = {
    'current': '`NAME/current`, A of the amplifier', 'spool': '`NAME/spool`, m',
    'pressure': '`NAME/pressure`, Pa of chamber A less that of B',
    'force': 'effort, N or Nm', 'position': 'position and velocity',
    'impedance': 'position, velocity, effort, stiffness, damping'}


def state_table() -> list[str]:
    """Return the lines of the table of transitions."""
    return markdown([('state', 'event', 'if', 'next state', 'effect'), *(
        (STATES[row.state], EVENTS[row.event], row.guard.replace('_', '\\_'),
         STATES[row.following], row.does) for row in TRANSITIONS)])


def event_table() -> list[str]:
    """Return the lines of the table of events."""
    return markdown([('event', 'cause'), *(
        (event, EVENT_WORDS[event]) for event in EVENTS)])


def mode_table() -> list[str]:
    """Return the lines of the table of modes."""
    return markdown([('mode', 'number', 'blocks that act, if they are on', 'setpoint'), *(
        (mode, str(MODES.index(mode)), _BLOCKS[mode], _SETPOINTS[mode]) for mode in MODES[1:])])


TABLES = {'states': state_table, 'events': event_table, 'modes': mode_table}
"""Function of each table by its name in the page."""


def with_tables(page: str) -> str:
    """Return a page with its tables anew, each marked ``table NAME``."""
    return with_parts(page, {f'table {name}': table() for name, table in TABLES.items()})
