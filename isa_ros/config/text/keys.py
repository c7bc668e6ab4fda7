"""
Keys of a run file and the kinds of their values: one row a key, read, written and compared by it.

A row has the key's name, kind, meaning and default, and says whether a resolved text has the key.
A kind converts the value of a key to a tree of a file and back. `leaves` walks all values of a
configuration with their rows, for lists of values and units; docs/run_file.md shows the rows.
Sections of several keys are kinds too: `isa_ros.config.text.key_tables`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from enum import Enum
from typing import Any, get_type_hints, NamedTuple

from isa_ros.config.text.names import refuse_bad_name
from isa_ros.config.text.parameter_sets import as_tree, build_one_of, members
from isa_ros.config.text.sections import (
    KIND_KEYS, names_at, Place, Section, section_at, written)
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check, Parameters
from isa_ros.errors import ConfigError

REQUIRED = object()
"""Default of a key that every file has."""


class KeyDifference(NamedTuple):
    """A key that only the text or only this version has."""

    text: str
    is_obstacle: bool
    """Whether it prevents the simulation of the run."""


class Leaf(NamedTuple):
    """A value of a configuration, or one of its parameter sets, with its row."""

    key: str
    """Dotted, as in the resolved text."""
    value: Any
    row: 'Key'


class ValueKind:
    """Conversion of the value of one key to a tree and back; written as it is by default."""

    words: str
    """Of the values, for the reference page."""
    unit = ''

    def read(self, tree: Any, place: Place) -> Any:
        """
        Return the value of a tree; inverse of `tree`.

        Raises
        ------
        ConfigError
            The tree is not one of this kind.

        """
        return tree

    def tree(self, value: Any) -> Any:
        """Return the value as a tree of scalars, lists and sections."""
        return list(value) if isinstance(value, tuple) else value

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return the rows of the section ``tree`` of this kind, or why they are unknown here."""
        return {}

    def leaves(self, value: Any, key: str, row: 'Key') -> Iterator[Leaf]:
        """Yield the values below ``key``, whose row is ``row``."""
        yield Leaf(key, value, row)


class Value(ValueKind):
    """One value, or a list of them, which ``check`` returns or refuses at a place."""

    def __init__(self, words: str, check: Callable[[Any, Place], Any], unit: str = '') -> None:
        self.words, self.unit, self._check = words, unit, check

    def read(self, tree: Any, place: Place) -> Any:
        """Return the value; as `ValueKind.read`."""
        return self._check(tree, place)


def of_type(value: Any, type_: type, place: Place) -> Any:
    """Return a value of exactly this type; as `ValueKind.read`."""
    if type(value) is not type_:
        raise ConfigError(f'{place} = {value!r}, must be of type {type_.__name__}')
    return value


def _named(is_placed: bool) -> Callable[[Any, Place], Any]:
    def checked(value: Any, place: Place) -> Any:
        refuse_bad_name(value, str(place), is_placed=is_placed)
        return value
    return checked


def choice_of(names: Sequence[str]) -> Value:
    """Return the kind of one name out of a list."""
    def checked(value: Any, place: Place) -> Any:
        check(str(place), value, {'names': names})
        return value
    return Value(' or '.join(names), checked)


ANY_NAME = Value('name', lambda value, place: value)
"""A name that is checked with the data that it names."""
NAME = Value('name', _named(is_placed=False))
PLACED_NAME = Value('name', _named(is_placed=True))
"""A name that may begin with a namespace and a slash."""
NAMES = Value('list of names', lambda value, place: tuple(names_at(value, place)))
TEXT = Value('text', lambda value, place: of_type(value, str, place))
FLAG = Value('true or false', lambda value, place: of_type(value, bool, place))


@frozen
class ParameterSet(ValueKind):
    """A parameter set, or one of a union, selected by the kind in its section."""

    hint: Any
    words = 'section'

    def tree(self, value: Parameters) -> Tree:
        """Return the section."""
        return as_tree(value, self.hint)

    def read(self, tree: Any, place: Place) -> Any:
        """Return the checked set; as `ValueKind.read`."""
        return build_one_of(self.hint, written(section_at(tree, place), place), place)

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return a row for each parameter, and for the kind."""
        if isinstance(self.hint, type):
            return parameter_rows(self.hint)
        kinds = members(self.hint)
        for name in KIND_KEYS:
            if name in tree:
                found = of_kind(tree[name], kinds, place)
                return found if isinstance(found, KeyDifference) else {
                    name: Key(name, ANY_NAME, ''), **parameter_rows(found)}
        return KeyDifference(f'{place / "kind"} is missing in the bag', True)


@frozen
class NamedSets(ParameterSet):
    """Parameter sets by name, each one of a union."""

    words = 'sections by name'

    def rows(self, tree: Any, place: Place) -> 'Mapping[str, Key] | KeyDifference':
        """Return a row for each section."""
        return {name: Key(name, ParameterSet(self.hint), '') for name in tree}


class Layer(ParameterSet):
    """Values of a parameter set that replace those of a model, each with its place."""

    def read(self, tree: Any, place: Place) -> Section:
        """Return the section; as `ValueKind.read`."""
        return written(section_at(tree, place), place)


def of_kind(kind: Any, kinds: Mapping[str, Any], place: Place) -> Any:
    """Return the one of some kinds that a file names, perhaps with a section or a list."""
    if isinstance(kind, str) and kind in kinds:
        return kinds[kind]
    return KeyDifference(f'{place}: the kind {kind!r} is unknown here', True)


def parameter_rows(cls: type[Parameters]) -> dict[str, 'Key']:
    """Return the rows of the fields of a parameter set by name."""
    hints = get_type_hints(cls)
    return {f.name: Key(
        f.name, ANY_NAME if 'doc' in f.metadata else NamedSets(f.metadata['named'])
        if 'named' in f.metadata else ParameterSet(hints[f.name]),
        f.metadata.get('doc', ''), _default(f.metadata, hints[f.name])) for f in fields(cls)}


def _default(declared: Mapping[str, Any], hint: Any) -> Any:
    """Return the value of a parameter that a file leaves out, as text, or `REQUIRED`."""
    absent = declared.get('absent', REQUIRED)
    if isinstance(absent, Parameters):
        return as_tree(absent, hint).get('kind', 'its default')
    return absent


def differences(kind: ValueKind, tree: Any, place: Place) -> Iterator[KeyDifference]:
    """Yield the keys below ``place`` that differ from those of this version."""
    if not isinstance(tree, dict):
        return  # refused by `read`
    rows = kind.rows(tree, place)
    if isinstance(rows, KeyDifference):
        yield rows
        return
    for name in tree if rows else ():
        if name not in rows:
            yield KeyDifference(f'{place / name} is unknown here', True)
    for name, key in rows.items():
        missing = f'{place / name} is missing in the bag'
        if name in tree:
            yield from differences(key.kind, tree[name], place / name)
        elif key.in_text in (InText.ALWAYS, InText.ONLY) or key.default is REQUIRED:
            yield KeyDifference(missing, True)
        elif key.in_text is InText.IF_ANY and key.default is not None:
            yield KeyDifference(f'{missing}, {key.default_words} is meant', False)


class InText(Enum):
    """Presence of a key in a resolved text."""

    NEVER = 'resolved into other keys'
    IF_ANY = 'unless it is None'
    ALWAYS = 'a text without it cannot be simulated'
    ONLY = 'as before, and hardly in a file written by hand: never suggested for a wrong key'


@frozen
class Key:
    """One key of a section: one row of a `KeyTable`."""

    name: str
    kind: ValueKind
    meaning: str
    default: Any = REQUIRED
    """As a file would have it; None: no value."""
    meant: str = ''
    """Words for the default, '' for the default itself."""
    in_text: InText = InText.IF_ANY
    instead_of: tuple[str, ...] = ()
    """Keys that a section with this one does not have."""
    of: Callable[[Any], Any] | None = None
    """Returns the value from the configuration of the section; None: its field of this name."""

    @property
    def default_words(self) -> str:
        """Return the default as text, '' for none."""
        if self.meant or self.default in (REQUIRED, None):
            return self.meant
        if isinstance(self.default, (list, dict)) and not self.default:
            return 'none'
        return str(self.default).lower()

    def value(self, config: Any) -> Any:
        """Return the value from the configuration of the section."""
        if self.of is not None:
            return self.of(config)
        return config[self.name] if isinstance(config, dict) else getattr(config, self.name)

    def read(self, section: Tree, place: Place) -> Any:
        """Return the value in a section, or the default."""
        given = section.get(self.name, self.default)
        if given is None and self.name not in section:
            return None
        return self.kind.read(given, place / self.name)


def number(name: str, unit: str, meaning: str, default: float | None, *, meant: str = '',
           in_text: InText = InText.IF_ANY, instead_of: tuple[str, ...] = (),
           **bounds: float) -> Key:
    """Return the row of a number; ``bounds`` as those of `isa_ros.core.parameter.parameter`."""
    def checked(value: Any, place: Place) -> float:
        check(str(place), value, {'doc': meaning, 'unit': unit, 'bounds': bounds})
        return float(value)
    return Key(
        name, Value('number', checked, unit), meaning, default, meant, in_text, instead_of)


def nanoseconds(name: str, meaning: str, instead_of: Key, **bounds: float) -> Key:
    """Return the row of a resolved text for a time of a run file in another unit."""
    def checked(value: Any, place: Place) -> int:
        check(str(place), of_type(value, int, place), {
            'doc': instead_of.meaning, 'unit': 'ns', 'bounds': bounds})
        return int(value)
    return Key(
        name, Value('whole number', checked, 'ns'), f'{meaning} instead of `{instead_of.name}`',
        None, in_text=InText.ONLY, instead_of=(instead_of.name,))
