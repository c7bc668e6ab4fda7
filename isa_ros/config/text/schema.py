"""
Schema of a resolved configuration: writes, reads and compares its keys.

The keys are declared once: a `Section` lists the keys of a dataclass with the kind of each, and
every kind converts its value to a tree and back.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
import math
from typing import Any, get_type_hints, NamedTuple, Protocol

from isa_ros.config.text.parameter_sets import as_tree, build_one_of, members
from isa_ros.config.text.sections import (
    KIND_KEYS, names_at, Place, refuse_unknown, section_at, written)
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.parameter import Parameters
from isa_ros.errors import ConfigError


class KeyDifference(NamedTuple):
    """A key that only the text or only this version has."""

    text: str
    is_obstacle: bool
    """Whether it prevents the simulation of the run."""


class Kind(Protocol):
    """Conversion of the value of one key to a tree and back."""

    def tree(self, value: Any) -> Any:
        """Return the value as a tree of scalars, lists and sections."""
        ...

    def read(self, tree: Any, place: Place) -> Any:
        """
        Return the value of a tree; inverse of `tree`.

        Raises
        ------
        ConfigError
            The tree is not the result of `tree` for any value.

        """
        ...

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys below ``place`` that differ from those of this version."""
        ...


@dataclass(frozen=True)
class Plain:
    """One scalar of exactly this type."""

    type_: type

    def tree(self, value: Any) -> Any:
        """Return the value."""
        return value

    def read(self, tree: Any, place: Place) -> Any:
        """Return the value; as `Kind.read`."""
        if type(tree) is not self.type_:
            raise ConfigError(f'{place} = {tree!r}, must be of type {self.type_.__name__}')
        if isinstance(tree, float) and not math.isfinite(tree):
            raise ConfigError(f'{place} = {tree}, must be finite')
        return tree

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield nothing: a scalar has no keys."""
        yield from ()


class Names:
    """A list of names."""

    def tree(self, value: Sequence[str]) -> list[str]:
        """Return the list."""
        return list(value)

    def read(self, tree: Any, place: Place) -> tuple[str, ...]:
        """Return the names; as `Kind.read`."""
        return tuple(names_at(tree, place))

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield nothing: a list of names has no keys."""
        yield from ()


@dataclass(frozen=True)
class ParameterSet:
    """A parameter set, or one of a union, selected by the kind in its section."""

    hint: Any

    def tree(self, value: Parameters) -> Tree:
        """Return the section."""
        return as_tree(value, self.hint)

    def read(self, tree: Any, place: Place) -> Any:
        """Return the checked set; as `Kind.read`."""
        return build_one_of(self.hint, written(section_at(tree, place), place), place)

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys that differ, or an unknown kind."""
        if not isinstance(tree, dict):
            return
        hint, rest = self.hint, dict(tree)
        if not isinstance(hint, type):
            kinds = members(hint)
            named = [rest.pop(key) for key in KIND_KEYS if key in rest]
            if not named:
                yield KeyDifference(f'{place / "kind"} is missing in the bag', True)
            elif not _is_one_of(named[0], kinds):
                yield KeyDifference(f'{place}: the kind {named[0]!r} is unknown here', True)
            if not named or not _is_one_of(named[0], kinds):
                return
            hint = kinds[named[0]]
        yield from _parameter_differences(hint, rest, place)


def _is_one_of(kind: Any, kinds: Mapping[str, Any]) -> bool:
    """Return whether a value of a file, perhaps a section or a list, is one of some kinds."""
    return isinstance(kind, str) and kind in kinds


def _parameter_differences(
        cls: type[Parameters], tree: Tree, place: Place) -> Iterator[KeyDifference]:
    hints = get_type_hints(cls)
    for key in tree:
        if key not in hints:
            yield KeyDifference(f'{place / key} is unknown here', True)
    for f in fields(cls):
        if f.name in tree:
            if 'doc' not in f.metadata:
                yield from ParameterSet(hints[f.name]).differences(tree[f.name], place / f.name)
        elif 'absent' in f.metadata:
            meant = f.metadata['absent']
            if isinstance(meant, Parameters):
                meant = as_tree(meant, hints[f.name]).get('kind', 'its default')
            yield KeyDifference(
                f'{place / f.name} is missing in the bag, {meant} is meant', False)
        else:
            yield KeyDifference(f'{place / f.name} is missing in the bag', True)


@dataclass(frozen=True)
class Key:
    """One key of a `Section`."""

    kind: Kind
    meant: str | None = None
    """Description of the default for a text without the key; the dataclass has the default. None:
    every text has the key, unless it is optional."""
    is_optional: bool = False
    """Whether the value may be None; then the key is not written."""


@dataclass(frozen=True)
class Section:
    """The keys of a dataclass, in the order in which they are written."""

    cls: type
    keys: Mapping[str, Key]

    def tree(self, value: Any) -> Tree:
        """Return the section of a value."""
        return {name: key.kind.tree(getattr(value, name)) for name, key in self.keys.items()
                if not (key.is_optional and getattr(value, name) is None)}

    def read(self, tree: Any, place: Place, **given: Any) -> Any:
        """Return the value of a section; ``given`` are the fields that it does not contain."""
        section = section_at(tree, place)
        refuse_unknown(section, self.keys, place)
        values = dict(given)
        for name, key in self.keys.items():
            if name in section:
                values[name] = key.kind.read(section[name], place / name)
            elif key.is_optional:
                values[name] = None
            elif key.meant is None:
                raise ConfigError(place.has(f'lacks {name}'))
        return self.cls(**values)

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys that differ; a tree that is not a section is refused by `read`."""
        if not isinstance(tree, dict):
            return
        for name in tree:
            if name not in self.keys:
                yield KeyDifference(f'{place / name} is unknown here', True)
        for name, key in self.keys.items():
            if name in tree:
                yield from key.kind.differences(tree[name], place / name)
            elif key.meant is not None:
                yield KeyDifference(
                    f'{place / name} is missing in the bag, {key.meant} is meant', False)
            elif not key.is_optional:
                yield KeyDifference(f'{place / name} is missing in the bag', True)


class NamedSection(Protocol):
    """Interface of the sections in `Named`, such as `Section`."""

    def tree(self, value: Any) -> Tree:
        """Return the section of a value."""
        ...

    def read(self, tree: Any, place: Place, **given: Any) -> Any:
        """Return the value; as `Section.read`."""
        ...

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys that differ."""
        ...


@dataclass(frozen=True)
class Named:
    """Sections by name, each of a dataclass that has the name as a field."""

    section: NamedSection

    def tree(self, value: Sequence[Any]) -> Tree:
        """Return the sections by name."""
        return {item.name: self.section.tree(item) for item in value}

    def read(self, tree: Any, place: Place) -> tuple[Any, ...]:
        """Return the values in order; as `Kind.read`."""
        return tuple(self.section.read(below, place / name, name=name)
                     for name, below in section_at(tree, place).items())

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys that differ, section by section."""
        for name, below in tree.items() if isinstance(tree, dict) else ():
            yield from self.section.differences(below, place / name)


@dataclass(frozen=True)
class OneOf:
    """One of several sections, selected by its key ``kind``."""

    sections: Mapping[str, Section]

    def tree(self, value: Any) -> Tree:
        """Return the section with its kind."""
        kind = next(name for name, section in self.sections.items()
                    if isinstance(value, section.cls))
        return {'kind': kind} | self.sections[kind].tree(value)

    def read(self, tree: Any, place: Place) -> Any:
        """Return the value; as `Kind.read`."""
        rest = dict(section_at(tree, place))
        kind = rest.pop('kind', None)
        if not _is_one_of(kind, self.sections):
            raise ConfigError(
                f'{place / "kind"} = {kind!r}, must be one of {", ".join(self.sections)}')
        return self.sections[str(kind)].read(rest, place)

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys that differ, or an unknown kind."""
        if not isinstance(tree, dict):
            return
        rest = dict(tree)
        kind = rest.pop('kind', None)
        if _is_one_of(kind, self.sections):
            yield from self.sections[str(kind)].differences(rest, place)
        else:
            yield KeyDifference(f'{place}: the kind {kind!r} is unknown here', True)
