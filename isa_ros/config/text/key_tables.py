"""Tables of keys: a section with known keys, with names of the user, or with a choice of kinds."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from isa_ros.config.text.keys import (
    ANY_NAME, InText, Key, KeyDifference, Leaf, of_kind, REQUIRED, ValueKind)
from isa_ros.config.text.names import refuse_bad_name
from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import listed
from isa_ros.errors import ConfigError


@frozen
class KeyTable(ValueKind):
    """The keys of a section, in the order in which they are written."""

    keys: tuple[Key, ...]
    rest: Key | None = None
    """Row of a parameter set whose keys stand beside the others."""
    words = 'section'

    @property
    def names(self) -> list[str]:
        """Return the names of the rows."""
        return [key.name for key in self.keys]

    def read(self, tree: Any, place: Place) -> dict[str, Any]:
        """Return the values by row; as `ValueKind.read`."""
        section = section_at(tree, place)
        if self.rest is None:
            refuse_unknown(
                self._rest_of(section),
                [key.name for key in self.keys if key.in_text is not InText.ONLY], place)
        lacking = [key for key in self.keys
                   if key.default is REQUIRED and key.name not in section]
        if lacking:
            meaning = f', {lacking[0].meaning}' if len(lacking) == 1 else ''
            raise ConfigError(place.has(
                f'lacks {listed([key.name for key in lacking])}{meaning}'))
        for key in self.keys:
            for other in key.instead_of if key.name in section else ():
                if other in section:
                    raise ConfigError(place.has(
                        f'has {other} and {key.name}, must have only one of them'))
        values = {key.name: key.read(section, place) for key in self.keys}
        if self.rest is not None:
            rest = self._rest_of(section)
            rows = self.rest.kind.rows(rest, place)
            if isinstance(rows, Mapping):
                refuse_unknown(rest, [*self.names, *rows], place)
            values[self.rest.name] = self.rest.kind.read(self._rest_of(section), place)
        return values

    def _rest_of(self, section: Tree) -> Tree:
        return {name: value for name, value in section.items() if name not in self.names}

    def tree(self, value: Any) -> Tree:
        """Return the section of a configuration."""
        tree: Tree = {} if self.rest is None else self.rest.kind.tree(self.rest.value(value))
        for key in self.keys:
            own = None if key.in_text is InText.NEVER else key.value(value)
            if own is not None:
                tree[key.name] = key.kind.tree(own)
        return tree

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return the rows, and those of the set whose keys stand beside them."""
        rest = {} if self.rest is None else self.rest.kind.rows(tree, place)
        return rest if isinstance(rest, KeyDifference) else {
            **rest, **{key.name: key for key in self.keys}}

    def leaves(self, value: Any, key: str, row: Key | None = None) -> Iterator[Leaf]:
        """Yield the values of a section."""
        if self.rest is not None:
            yield from self.rest.kind.leaves(self.rest.value(value), key, self.rest)
        for below in self.keys:
            own = None if below.in_text is InText.NEVER else below.value(value)
            if own is not None:
                yield from below.kind.leaves(
                    own, f'{key}.{below.name}' if key else below.name, below)


@frozen
class NamedSections(ValueKind):
    """Sections by name, each of a configuration that has its name as a field."""

    section: ValueKind
    are_placed: bool = False
    """Whether the names may begin with a namespace and a slash."""
    words = 'sections by name'

    def tree(self, value: Sequence[Any]) -> Tree:
        """Return the sections by name."""
        return {item.name: self.section.tree(item) for item in value}

    def read(self, tree: Any, place: Place) -> dict[str, Any]:
        """Return the values by name; as `ValueKind.read`."""
        values = {}
        for name, below in section_at(tree, place).items():
            refuse_bad_name(name, f'{place / name}: the name', is_placed=self.are_placed)
            values[name] = self.section.read(below, place / name)
        return values

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return a row for each section."""
        return {name: Key(name, self.section, '') for name in tree}

    def leaves(self, value: Sequence[Any], key: str, row: Key) -> Iterator[Leaf]:
        """Yield the values of all sections."""
        for item in value:
            yield from self.section.leaves(item, f'{key}.{item.name}', row)


@frozen
class OneOf(ValueKind):
    """One of several sections, selected by its key ``kind``; a configuration has its kind."""

    tables: Mapping[str, KeyTable]
    words = 'section'

    def tree(self, value: Any) -> Tree:
        """Return the section with its kind."""
        return {'kind': value.kind} | self.tables[value.kind].tree(value)

    def read(self, tree: Any, place: Place) -> dict[str, Any]:
        """Return the values with their kind; as `ValueKind.read`."""
        rest = dict(section_at(tree, place))
        kind = rest.pop('kind', None)
        if not isinstance(kind, str) or kind not in self.tables:
            raise ConfigError(
                f'{place / "kind"} = {kind!r}, must be one of {", ".join(self.tables)}')
        return {'kind': kind} | self.tables[kind].read(rest, place)

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return the rows of the section's kind, and one for the kind."""
        found = of_kind(tree.get('kind'), self.tables, place)
        return found if isinstance(found, KeyDifference) else {
            'kind': Key('kind', ANY_NAME, ''), **found.rows(tree, place)}

    def leaves(self, value: Any, key: str, row: Key) -> Iterator[Leaf]:
        """Yield the values of the section."""
        yield from self.tables[value.kind].leaves(value, key)
