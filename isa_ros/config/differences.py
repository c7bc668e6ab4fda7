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
from isa_ros.config.runs.run_config import RUN
from isa_ros.config.runs.run_reading import run_of_tree
from isa_ros.config.runs.supplies import SUPPLY
from isa_ros.config.text.keys import differences, KeyDifference
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


def key_differences(tree: Tree, place: Place) -> Iterator[KeyDifference]:
    """Yield what a resolved configuration has that is unknown here, and what it lacks."""
    yield from differences(RUN, modern(tree), place)


def modern(tree: Tree) -> Tree:
    """Return the tree of a resolved configuration that may still say ``supply`` and ``leg``."""
    tree = dict(tree)
    actuators, supply = tree.get('actuators'), tree.get(SUPPLY)
    if isinstance(supply, dict) and isinstance(actuators, dict) and 'supplies' not in tree:
        del tree[SUPPLY]
        tree['supplies'] = {SUPPLY: supply | {'feeds': list(actuators)}}
    if isinstance(tree.get('leg'), dict) and 'body' not in tree:
        leg: Tree = {'kind': 'leg'}
        tree['body'] = leg | tree.pop('leg')  # type: ignore[operator]
    return tree


def _units(tree: Tree) -> dict[str, str]:
    """Return the unit of every number by key; of nothing where another version wrote it."""
    try:
        run = run_of_tree(tree, '')
    except ConfigError:
        return {}
    units: dict[str, str] = {}
    for key, value, row in RUN.leaves(run, ''):
        if isinstance(value, Parameters):
            units |= {f'{key}.{below.parameter}': below.unit for below in rows(value, {})}
        else:
            units[key] = row.kind.unit
    for actuator in run.actuators:
        own = f'actuators.{actuator.name}.'
        for gain in tunables(actuator.sheet).values():  # m/N where the sheet has output/measured
            if gain.scale == 1.0:
                units[f'{own}sheet.{gain.key}'] = gain.unit
        units |= {key: of_coordinate(unit, actuator.sheet.is_rotary)
                  for key, unit in units.items() if key.startswith(own)}
    return units


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
