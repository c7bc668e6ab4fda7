"""
Tolerances between two bags by topic and field; fields without one must be equal.

A tolerance file has for each topic and field a number (absolute, in the field's unit) or both
bounds; a field without index stands for every element::

    /haa/joint_states:
      position: 1.0e-6
      effort: {absolute: 1.0e-3, relative: 1.0e-6}
    '*': {'*': {relative: 1.0e-9}}

A topic ``*`` stands for every topic, a field ``*`` for every float of a message; those that are
named have their own.
"""

from collections.abc import Mapping
import math
from pathlib import Path
import re
from typing import NamedTuple

from isa_ros.config.text import yaml_text as strict_yaml
from isa_ros.config.text.yaml_text import Tree
from isa_ros.errors import ConfigError
from msg_adapters.cdr import field_type, Message
from msg_adapters.cdr_reader import message_class
import numpy as np
from numpy.typing import NDArray

ALL = '*'
"""A topic or field that stands for all that are not named."""
FLOATS = ('float', 'double')
_INDEX = re.compile(r'\[\d+\]')


class Tolerance(NamedTuple):
    """Allowed distance from the expected value."""

    absolute: float = 0.0  # in the field's unit
    relative: float = 0.0  # of the expected value

    def bound(self, expected: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the allowed distance from each of the expected values, (n,)."""
        bound: NDArray[np.float64] = self.absolute + self.relative * np.abs(expected)
        return bound


class Tolerances:
    """Tolerances by topic and field; by default every bit must be equal."""

    def __init__(self, by_field: Mapping[tuple[str, str], Tolerance] | None = None) -> None:
        self._by_field = dict(by_field or {})

    def of(self, topic: str, field: str) -> Tolerance | None:
        """Return the tolerance of a field path; one given with the index comes first."""
        exact = self._by_field.get((topic, field))
        return exact or self._by_field.get((topic, _INDEX.sub('', field)))

    def covers(self, topic: str) -> bool:
        """Return whether a field of a topic has a tolerance."""
        return any(own == topic for own, _ in self._by_field)


def load_tolerances(path: Path, types: Mapping[str, str]) -> Tolerances:
    """
    Read a tolerance file for bags with these message types by topic.

    Raises
    ------
    ConfigError
        An unknown topic or field, a field that is not a float, or a bound that is
        not a finite number >= 0; the message has file, key and value.

    """
    by_field: dict[tuple[str, str], Tolerance] = {}
    tree = strict_yaml.read(path)
    every = tree.get(ALL, {ALL: 0.0})
    if not isinstance(every, dict) or list(every) != [ALL]:
        raise ConfigError(
            f'{path.name}: {ALL} = {every!r}, must be {{{ALL!r}: BOUND}}, a bound for every '
            'float')
    for topic, section in _spread(tree, types).items():
        if topic not in types:
            raise ConfigError(
                f'{path.name}: {topic}: no such topic in the bag, which has '
                f'{", ".join(sorted(types))}')
        if not isinstance(section, dict):
            raise ConfigError(f'{path.name}: {topic} = {section!r}, must be a section of fields')
        fields = _fields(message_class(types[topic]))
        for field, bound in _of_every(section, fields).items():
            where = f'{path.name}: {topic}: {field}'
            _check_field(where, field, fields)
            by_field[topic, field] = _tolerance(where, bound)
    return Tolerances(by_field)


def _spread(tree: Tree, types: Mapping[str, str]) -> Tree:
    """Return the sections by topic; those of `ALL` are beneath those of each topic."""
    below = tree.get(ALL)
    if not isinstance(below, dict):
        return tree
    spread: Tree = dict.fromkeys(types, below)
    for topic, section in tree.items():
        if topic != ALL:
            spread[topic] = {**below, **section} if isinstance(section, dict) else section
    return spread


def _of_every(section: Tree, fields: Mapping[str, str]) -> Tree:
    """Return the bounds by field; that of `ALL` is the one of every float not named."""
    if ALL not in section:
        return section
    every: Tree = {name: section[ALL] for name, item in fields.items() if item in FLOATS}
    return every | {name: bound for name, bound in section.items() if name != ALL}


def _fields(cls: type[Message], prefix: str = '') -> dict[str, str]:
    """Return the element type of every field path, without indices."""
    found: dict[str, str] = {}
    for name, declared in cls.get_fields_and_field_types().items():
        item = field_type(declared).item
        if '/' in item:
            found |= _fields(message_class(item), f'{prefix}{name}.')
        else:
            found[f'{prefix}{name}'] = item
    return found


def _check_field(where: str, field: str, fields: Mapping[str, str]) -> None:
    floats = [name for name, item in fields.items() if item in FLOATS]
    if _INDEX.sub('', field) not in floats:
        raise ConfigError(f'{where}: must be a float field of the message: {", ".join(floats)}')


def _tolerance(where: str, bound: object) -> Tolerance:
    bounds = bound if isinstance(bound, dict) else {'absolute': bound}
    if not bounds or set(bounds) - set(Tolerance._fields):
        raise ConfigError(
            f'{where} = {bound!r}, must be a number or have {" and ".join(Tolerance._fields)}')
    return Tolerance(**{name: _bound(where, name, value) for name, value in bounds.items()})


def _bound(where: str, name: str, value: object) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if math.isfinite(value) and value >= 0.0:
            return float(value)
    raise ConfigError(f'{where}: {name} = {value!r}, must be a finite number >= 0')
