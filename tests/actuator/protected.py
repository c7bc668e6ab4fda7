"""An actuator whose protection watches, advanced and cleared."""

from typing import Any

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.timing import Timing
from isa_ros.core.record import row_record
from isa_ros.core.signals import COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE
import numpy as np
from tests.sheets import actuator_sheet, override, smart_actuator, TICK

OFFSET_STEPS, CONVERSION_STEPS = 6, 5


def protected(timing: Timing = TICK, load: str = 'mass', **values: Any) -> SmartActuator:
    """Return an ISA v5 with other values of its protection; ``__`` separates keys."""
    sheet = actuator_sheet('isa_v5')
    for path, value in values.items():
        sheet = override(sheet, f'reu.protection.{path.replace("__", ".")}', value)
    return smart_actuator('isa_v5', load, sheet=sheet, timing=timing)


def ticks(actuator: SmartActuator, n: int) -> None:
    for _ in range(n):
        actuator.tick()


def clear(actuator: SmartActuator) -> None:
    """Clear the fault, and enable again in the same tick."""
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['is_enabled'] = HAS_ENABLE | HAS_CLEAR_FAULT, 1
    actuator.accept(command)


def own(actuator: SmartActuator) -> np.record:
    return row_record(actuator.memory.reu).protection
