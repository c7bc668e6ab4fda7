"""
Differences between two resolved configurations: key, both values, unit.

The sections are those that a bag carries, perhaps of another version, so that any section is
compared; units are known for keys of this version.
"""

from collections.abc import Iterator, Mapping
from itertools import zip_longest
import re
from typing import Any, NamedTuple

from isa_ros.actuator.tunable import tunables
from isa_ros.config.listing import rows
from isa_ros.config.runs.run_config import ActuatorConfig, modern, RUN, RunConfig
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.parameter import Parameters
from isa_ros.core.units import of_coordinate
from isa_ros.errors import ConfigError

ABSENT = 'absent'

_LONGEST = 40   # characters of a value in a table
_SHEET = re.compile(r'^(actuators\.[^.]+)\.sheet\.')


class DifferingKey(NamedTuple):
    """One key with different values; None: the key, or its section, is absent."""

    key: str
    expected: Any
    actual: Any
    unit: str = ''

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Return key, both values and unit as the cells of a table."""
        return self.key, _shown(self.expected), _shown(self.actual), self.unit


def configuration_differences(expected: Tree, actual: Tree) -> list[DifferingKey]:
    """
    Return the keys in which two resolved configurations differ, in their order.

    Parameters of actuators have the keys of run files: ``actuators.knee.parameters.reu...``.
    """
    expected, actual = modern(expected), modern(actual)
    units = _units(expected) | _units(actual)
    return [difference._replace(
                key=_SHEET.sub(r'\1.parameters.', difference.key),
                unit=units.get(difference.key, ''))
            for difference in section_differences(expected, actual)]


def section_differences(
        expected: Mapping[str, Any], actual: Mapping[str, Any]) -> list[DifferingKey]:
    """Return the dotted keys in which two sections differ; entries of a list as ``key[k]``."""
    return list(_differences(expected, actual, ''))


def _differences(expected: Any, actual: Any, key: str) -> Iterator[DifferingKey]:
    if isinstance(expected, Mapping) and isinstance(actual, Mapping):
        for name in [*expected, *(name for name in actual if name not in expected)]:
            yield from _differences(
                expected.get(name), actual.get(name), f'{key}.{name}' if key else name)
    elif _has_sections(expected) and _has_sections(actual):
        for k, (one, other) in enumerate(zip_longest(expected, actual)):
            yield from _differences(one, other, f'{key}[{k}]')
    elif expected != actual:
        yield DifferingKey(key, expected, actual)


def _has_sections(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(entry, dict) for entry in value)


def _units(tree: Tree) -> dict[str, str]:
    """Return the unit of every number by key; of nothing where another version wrote it."""
    try:
        run: RunConfig = RUN.read(tree, Place(''))
    except ConfigError:
        return {}
    units = {'step_ns': 'ns', 'controller_offset_ns': 'ns', 'tick_timeout_s': 's'}
    units |= _units_of(run.record.storage, 'record')
    for supply in run.supplies:
        units |= _units_of(supply.sheet, f'supplies.{supply.name}')
    for actuator in run.actuators:
        key = f'actuators.{actuator.name}'
        units |= {f'{key}.{name}': of_coordinate(unit, actuator.sheet.is_rotary)
                  for name, unit in _units_of_actuator(actuator)}
    if run.leg is not None:
        units |= _units_of(run.leg.start, 'body.start') | _units_of(run.leg.sheet, 'body.sheet')
    return units


def _units_of_actuator(actuator: ActuatorConfig) -> Iterator[tuple[str, str]]:
    yield 'initial_position', 'm | rad'
    yield from _units_of(actuator.sheet, 'sheet').items()
    if actuator.load is not None:
        yield from _units_of(actuator.load, 'load').items()
    for gain in tunables(actuator.sheet).values():  # m/N where the sheet has output/measured
        if gain.scale == 1.0:
            yield f'sheet.{gain.key}', gain.unit


def _units_of(parameters: Parameters, key: str) -> dict[str, str]:
    return {f'{key}.{row.parameter}': row.unit for row in rows(parameters, {})}


def _shown(value: Any) -> str:
    if value is None:
        return ABSENT
    if isinstance(value, dict):
        inner = ', '.join(f'{key}: {_shown(below)}' for key, below in value.items())
        text = f'{{{inner}}}'
    elif isinstance(value, list):
        text = f'[{", ".join(map(_shown, value))}]'
    else:
        text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= _LONGEST else f'{text[:_LONGEST]}...'
