"""
Write the tables and figures of docs/device.md anew.

    python scripts/draw_device.py
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.timing import Timing
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.controller import Setpoint
from isa_ros.core.device import EVENTS, MODES, STATES
from isa_ros.core.signals import COMMAND
from isa_ros.requests import fill_command
from isa_ros.reu.transitions import TRANSITIONS
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

DOCS = Path(__file__).parents[1] / 'docs'
TICK = Timing(step_ns=100_000, controller_offset_ns=20_000)
TICK_MS = 0.1
SHIPPED, NONE = 5.0, 1e-3   # ms of the fade; with the latter a jump is there a period later
LABELS = ((NONE, 'without fade', 'C1'), (SHIPPED, 'as shipped', 'C0'))
CHANGES = ((20.0, {'mode': 'force', 'position': 0.05, 'effort': 400.0}, 'force'),
           (40.0, {'mode': 'spool', 'spool': 4e-5}, 'spool'),
           (60.0, {'mode': 'impedance', 'position': 0.06}, 'impedance'))
DURATION_MS, BEFORE_MS = 90.0, 20.0
GAIN_MS, GAIN_SHARE = 10.0, 0.5
EVENT_WORDS: Mapping[str, str] = {
    'start': 'start of the run',
    'ready': '`initialisation_ms` are over',
    'trip': 'a condition trips whose reaction is quick stop, disable or block',
    'clear fault': '`~/clear_fault`',
    'mode': 'parameter `mode`',
    'enable': '`~/enable` with true',
    'disable': '`~/enable` with false',
    'quick stop': '`~/quick_stop`',
    'stop ends': 'at rest for `quick_stop_hold_ms`; at once with `quick_stop: close`',
    'reaction ends': 'the same, or at once if the reaction is disable or block',
    'emergency stop': '`reu.device.emergency_stop` is 1: [emergency stop](#emergency-stop)'}
"""Cause of each event of `isa_ros.core.device.EVENTS`."""

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


def actuator(fade_ms: float) -> SmartActuator:
    """Return an ISA v5 with 50 kg that is on its way to a position 5 mm away."""
    config = default_actuator('isa_v5', 'knee')
    reu = config.sheet.reu
    sheet = replace(config.sheet, reu=replace(reu, device=replace(reu.device, fade_ms=fade_ms)))
    own = SmartActuator(replace(config, sheet=sheet), TICK)
    accept(own, position=0.055)
    for _ in range(round(BEFORE_MS / TICK_MS)):
        own.tick()
    return own


def accept(own: SmartActuator, **values: object) -> None:
    """Let a command take effect at the next tick."""
    command = np.zeros(1, COMMAND)[0]
    fill_command(own.name, Setpoint(**values), command)  # type: ignore[arg-type]
    own.accept(command)


def modes(fade_ms: float) -> np.ndarray:
    """Return the current (mA) of each conversion over the changes of mode."""
    own, found = actuator(fade_ms), []
    changes = {round(at / TICK_MS): values for at, values, _ in CHANGES}
    for k in range(round(DURATION_MS / TICK_MS)):
        if k in changes:
            accept(own, **changes[k])
        own.tick()
        found.append(float(own.sample.current_reference) * 1e3)
    return np.array(found)


def gains(fade_ms: float) -> np.ndarray:
    """Return the current (mA) of each conversion over a change of a gain."""
    own, found = actuator(fade_ms), []
    for k in range(round(2.0 * BEFORE_MS / TICK_MS)):
        if k == round(GAIN_MS / TICK_MS):
            own.tune({'reu.force.kv': GAIN_SHARE * own.parameter('reu.force.kv')})
        own.tick()
        found.append(float(own.sample.current_reference) * 1e3)
    return np.array(found)


def stop() -> tuple[np.ndarray, np.ndarray]:
    """Return position and its reference (mm) over a quick stop."""
    own, found = actuator(SHIPPED), []
    for k in range(2600):
        if k == 200:
            accept(own, quick_stop=True)
        own.tick()
        found.append((own.sample.position * 1e3, own.sample.position_reference * 1e3))
    return np.array(found).T


def over_time(axes: Axes, values: np.ndarray, label: str, color: str) -> None:
    """Draw values of consecutive conversions."""
    axes.step(np.arange(len(values)) * TICK_MS, values, color, where='post', label=label, lw=1)


def draw() -> Figure:
    """Return the figure."""
    figure = Figure((7.5, 8.0), layout='constrained')
    above, middle, below = figure.subplots(3)
    for fade_ms, label, color in LABELS:
        over_time(above, modes(fade_ms), label, color)
        over_time(middle, gains(fade_ms), label, color)
    for at, _, mode in CHANGES:
        above.axvline(at, color='0.7', lw=0.8)
        above.annotate(mode, (at, 1.0), xycoords=('data', 'axes fraction'), va='bottom')
    middle.axvline(GAIN_MS, color='0.7', lw=0.8)
    middle.set_title(f'force.kv times {GAIN_SHARE:g} at {GAIN_MS:g} ms', fontsize='medium')
    measured, reference = stop()
    over_time(below, reference, 'reference', '0.5')
    over_time(below, measured, 'encoder', 'C0')
    below.set_title('quick stop at 20 ms; the valve is at null from its end on',
                    fontsize='medium')
    for axes in (above, middle):
        axes.set_ylabel('current, mA')
        axes.legend(loc='upper right')
    below.set(ylabel='position, mm', xlabel='time, ms')
    below.legend()
    return figure


def main() -> None:
    """Write the figure and the tables."""
    draw().savefig(DOCS / 'figures' / 'device.png', dpi=90)
    page = DOCS / 'device.md'
    page.write_text(with_tables(page.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    main()
