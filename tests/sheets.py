"""The shipped actuators, for the tests."""

from dataclasses import replace
from typing import Any

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.timing import Timing
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.parameter_sets import build, build_one_of
from isa_ros.config.text.sections import SourcedValue
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.loads.sheets import LocalLoad
from isa_ros.plant.plant import plant_record
import numpy as np

MODELS = ('smart_manifold', 'isa_v2', 'isa_v5')
TICK = Timing(step_ns=1_000_000, controller_offset_ns=120_000)
"""The tick of most runs."""
FINE = Timing(step_ns=100_000, controller_offset_ns=20_000)
"""A tick as short as the current loop's period, for measuring transients."""


def actuator_sheet(model: str, preset: str = 'default', *variants: str) -> ActuatorSheet:
    """Return a shipped sheet."""
    found = actuator_model(model, 'test')
    section = found.with_variants(found.with_preset(preset, 'test'), variants, 'test')
    return build(ActuatorSheet, section, found.place)


def own_load(model: str, kind: str) -> LocalLoad:
    """Return one of the model's own loads."""
    found = actuator_model(model, 'test')
    section = {'kind': SourcedValue(kind, 'test', '')} | found.loads[kind]
    return build_one_of(LocalLoad, section, found.place)


def plant_row(model: str) -> np.record:
    """Return the `PLANT` record of a shipped sheet."""
    return plant_record(actuator_sheet(model).plant)[0]


def override(sheet: Any, path: str, value: Any) -> Any:
    """Return the sheet with one parameter or section replaced, ``path`` dotted."""
    head, _, rest = path.partition('.')
    below = getattr(sheet, head)
    changed = override(below, rest, value) if rest else value
    return replace(sheet, **{head: changed})


def smart_actuator(
        model: str, load: str | LocalLoad | None, *, preset: str = 'default',
        position: float | None = None, timing: Timing = FINE,
        sheet: ActuatorSheet | None = None) -> SmartActuator:
    """Return an actuator on one of its own loads, by default at mid stroke."""
    sheet = sheet or actuator_sheet(model, preset)
    if isinstance(load, str):
        load = own_load(model, load)
    if position is None:
        position = 0.5 * sheet.plant.drive.stroke
    return SmartActuator(
        ActuatorConfig(model, model, preset, sheet, load, position), timing)


def setpoint(**values: float) -> np.void:
    """Return a `COMMAND` row; missing gains keep those in force."""
    command = np.zeros(1, COMMAND)[0]
    command['kinds'] = HAS_SETPOINT
    command['stiffness'] = command['damping'] = np.nan
    for name, value in values.items():
        command[name] = value
    return command


def request(kinds: int, is_enabled: int = 0) -> np.void:
    """Return a `COMMAND` row without a setpoint."""
    row = np.zeros(1, COMMAND)[0]
    row['kinds'], row['is_enabled'] = kinds, is_enabled
    return row
