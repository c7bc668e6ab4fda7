"""
Sections of values, in layers; each value keeps the place it was written at, and its source.

A later layer (preset, run file) replaces single values of an earlier one (the model's sheet);
`isa_ros.config.text.parameter_sets` makes parameter sets of the result.
"""

from collections.abc import Iterable
from dataclasses import field
from pathlib import Path
from typing import Any

from isa_ros.actuator.scales import SCALES
from isa_ros.config.text.yaml_text import Scalar, Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError

_SOURCES = ('paper', 'derived', 'assumed', 'public model')
KIND_KEYS = ('kind', 'linkage')  # keys that may hold the kind of a section


@frozen
class SourcedValue:
    """One value, or a list of them, where it was written (``file: dotted key``), its source."""

    value: Scalar | list[Any]
    where: str
    source: str
    scales_with: str = ''
    """The quantity of `isa_ros.actuator.scales` that it is proportional to, '' for none."""


Section = dict[str, 'SourcedValue | Section']


@frozen
class Place:
    """A section of a file; messages about the section begin with its text."""

    file: str
    key: str = ''
    folder: Path = field(default=Path(), compare=False)
    """In which the file names others; the current one if it is unknown."""

    @classmethod
    def of(cls, path: Path) -> 'Place':
        """Return the place of a file."""
        return cls(path.name, folder=path.parent)

    def __truediv__(self, key: str) -> 'Place':
        return Place(self.file, f'{self.key}.{key}' if self.key else key, self.folder)

    def __str__(self) -> str:
        return f'{self.file}: {self.key}' if self.key else self.file

    def has(self, what: str) -> str:
        """Return a message about the section itself."""
        return f'{self}: {what}' if not self.key else f'{self} {what}'


def refuse_unknown(given: Iterable[str], names: Iterable[str], place: Place) -> None:
    """
    Refuse the first key that is not one of ``names``; the message has the nearest ones.

    For a key that differs from a name only in its unit the message says that the unit belongs
    to the key.

    Raises
    ------
    ConfigError
        A key is unknown.

    """
    names = list(names)
    for key in given:
        if key not in names:
            raise ConfigError(f'{place / key} is unknown; {alternatives(key, names)}')


def section_at(tree: Any, place: Place) -> Tree:
    """
    Return a value as a section.

    Raises
    ------
    ConfigError
        The value is a scalar or a list.

    """
    if not isinstance(tree, dict):
        raise ConfigError(f'{place} = {tree!r}, must be a section of `key: value`')
    return tree


def names_at(value: Any, place: Place) -> list[str]:
    """
    Return a value as a list of names.

    Raises
    ------
    ConfigError
        The value is not a list of names.

    """
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        raise ConfigError(f'{place} = {value!r}, must be a list of names')
    return value


def written(tree: Tree, place: Place) -> Section:
    """Return the plain numbers of a run file; their source is the file."""
    section: Section = {}
    for key, value in tree.items():
        if isinstance(value, dict):
            section[key] = written(value, place / key)
        else:
            section[key] = SourcedValue(value, str(place / key), place.file)
    return section


def sourced(tree: Tree, place: Place) -> Section:
    """
    Return the values of a model's sheet, each written as ``{value: ..., source: ...}``.

    A value may have the key ``scales_with``.

    Raises
    ------
    ConfigError
        A value lacks its source, the source begins with an unknown word, or there is no such
        quantity to scale with.

    """
    section: Section = {}
    for key, value in tree.items():
        if key in KIND_KEYS and isinstance(value, str):
            section[key] = SourcedValue(value, str(place / key), '')
            continue
        below = section_at(value, place / key)
        if 'value' not in below and 'source' not in below:
            section[key] = sourced(below, place / key)
            continue
        refuse_unknown(below, ('value', 'source', 'scales_with'), place / key)
        number, source = below.get('value'), below.get('source')
        if isinstance(number, dict) or not isinstance(source, str):
            raise ConfigError((place / key).has('needs a value and its source'))
        if not source.startswith(_SOURCES):
            raise ConfigError(
                f'{place / key}.source = {source!r}, must start with {" or ".join(_SOURCES)}')
        scale = str(below.get('scales_with', ''))
        if 'scales_with' in below:
            refuse_unknown([scale], SCALES, place / key / 'scales_with')
        section[key] = SourcedValue(number, str(place / key), source, scale)
    return section


def merge(base: Section, over: Section) -> Section:
    """
    Return ``base`` with single values replaced by those of ``over``.

    A section of another kind replaces the earlier section as a whole.
    """
    merged = dict(base)
    for key, value in over.items():
        below = merged.get(key)
        if (isinstance(value, dict) and isinstance(below, dict)
                and _kind(value) in (None, _kind(below))):
            merged[key] = merge(below, value)
        else:
            merged[key] = value
    return merged


def overlaid(base: Tree, over: Tree) -> Tree:
    """Return the tree of a file with other values; as `merge`, of values as they are written."""
    found = dict(base)
    for key, value in over.items():
        below = found.get(key)
        is_same = isinstance(value, dict) and isinstance(below, dict) and not any(
            kind in value and value[kind] != below.get(kind) for kind in KIND_KEYS)
        found[key] = overlaid(below, value) if is_same else value  # type: ignore[arg-type]
    return found


def entry_at(section: Section, key: str) -> SourcedValue | Section | None:
    """Return the value or section at a dotted key, None where there is none."""
    entry: SourcedValue | Section | None = section
    for part in key.split('.'):
        entry = entry.get(part) if isinstance(entry, dict) else None
    return entry


def _kind(section: Section) -> Scalar | list[Any]:
    """Return the kind of a section, None for a section without one."""
    named = [entry.value for key in KIND_KEYS
             if isinstance(entry := section.get(key), SourcedValue)]
    return named[0] if named else None
