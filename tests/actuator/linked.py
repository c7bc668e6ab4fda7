"""Actuators behind a link."""

from dataclasses import replace
from typing import Any

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.frames import LINE
from isa_ros.actuator.link import LinkSheet
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.timing import Timing
from isa_ros.core.record import rows_of
from tests.sheets import actuator_sheet, smart_actuator, TICK

MODEL = 'isa_v5'
STEPS = 50     # of the plant in a tick


def link_of(**values: float) -> LinkSheet:
    """Return the sheet of a link with a cycle of a tick, unless given otherwise."""
    absent = dict.fromkeys(
        ('delay_cycles', 'jitter_us', 'loss', 'burst_loss', 'burst_frames', 'duplicates',
         'reordered', 'watchdog_ms'), 0.0) | {'cycle_ms': 1.0}
    return LinkSheet(kind='ethercat', **(absent | values))


def linked(**values: float) -> ActuatorSheet:
    """Return the sheet of an actuator behind a link."""
    return replace(actuator_sheet(MODEL), link=link_of(**values))


def actuator(sheet: ActuatorSheet | None = None, timing: Timing = TICK) -> SmartActuator:
    """Return an actuator with a mass of its own; None: without a link."""
    return smart_actuator(MODEL, 'mass', timing=timing, sheet=sheet)


def line() -> Any:
    """Return an empty `LINE`."""
    return rows_of(1, LINE)[0]
