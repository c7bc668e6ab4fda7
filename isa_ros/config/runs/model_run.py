"""
The run file of one model alone, and the keys of its actuator.

What is measured or listed of a model is what a run file of a few lines would give: alone, on the
paper's supply. Keys of its values are those of the actuator as `isa params` shows them for the
model: ``reu.force.kp``, ``plant.oil.dead_volume_ml``, ``load.stiffness``, ``preset``.
"""

from collections.abc import Sequence
from typing import Any

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.config.models.catalogue import actuator_model, DEFAULT_PRESET
from isa_ros.config.text.changes import replaced, Values
from isa_ros.config.text.sections import entry_at, SourcedValue
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError

LOAD = 'load'
_OF_SHEET = ('spool_feedback', 'plant', 'reu')
_OF_ACTUATOR = (
    LOAD, 'preset', 'variants', 'initial_position_mm', 'initial_position_deg', 'beyond_range')


def model_run(name: str, preset: str | None = None, variants: Sequence[str] = ()) -> Tree:
    """
    Return the run file of a model alone, on its default load and the paper's supply.

    Raises
    ------
    ConfigError
        There is no such model, preset or variant.

    """
    model = actuator_model(name, 'model')
    preset = preset or DEFAULT_PRESET
    model.with_variants(model.with_preset(preset, '--preset'), variants, '--variant')
    actuator: Tree = {'model': model.name, 'preset': preset}
    if variants:
        actuator['variants'] = list(variants)
    for key in model.stated:
        entry = entry_at(model.sheet, key)
        assert isinstance(entry, SourcedValue)
        actuator = replaced(actuator, f'parameters.{key}', entry.value, model.name)
    return {
        'name': model.name,
        'supply': {'kind': 'constant', 'pressure_mpa': PAPER_SUPPLY / MPA,
                   'return_pressure_mpa': 0.0},
        'actuators': {model.name: actuator | {LOAD: {'kind': model.default_load}}}}


def full_key(key: str, actuator: str) -> str:
    """Return the key in a run file of a key that may be one of ``actuator``."""
    head = key.partition('.')[0]
    if head in _OF_SHEET:
        return f'actuators.{actuator}.parameters.{key}'
    if head in _OF_ACTUATOR:
        return f'actuators.{actuator}.{key}'
    return key


def full_keys(values: Values, actuator: str) -> dict[str, Any]:
    """
    Return values by their keys in a run file, as `full_key`.

    Raises
    ------
    ConfigError
        One value has two keys, and two numbers.

    """
    found: dict[str, Any] = {}
    given: dict[str, str] = {}
    for key, value in values.items():
        full = full_key(key, actuator)
        if full in found and found[full] != value:
            raise ConfigError(
                f'{given[full]} = {found[full]} and {key} = {value} are one value, must be given '
                'once')
        found[full], given[full] = value, key
    return found


def assumed_keys(model: str, values: Values) -> tuple[str, ...]:
    """Return what a model has of no data sheet, and ``values`` by full keys do not give either."""
    def is_given(key: str) -> bool:
        full = f'{full_key(key, model)}.'
        return any(full.startswith(f'{own}.') for own in values)
    return tuple(key for key in actuator_model(model, 'model').stated if not is_given(key))
