"""
Sections to checked parameter sets, and back.

Errors are reported with the file and key at which a value was written, be it a later layer's.
"""

from collections.abc import Callable, Mapping
from functools import cache
import re
from typing import Any, get_args, get_type_hints, TypeVar

from isa_ros.config.text.names import refuse_bad_name
from isa_ros.config.text.sections import KIND_KEYS, Place, Section, SourcedValue
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import fields_of
from isa_ros.core.parameter import check, Parameters, set_by_name
from isa_ros.core.suggest import alternatives, listed
from isa_ros.core.units import after, of_coordinate
from isa_ros.errors import ConfigError, ParameterError

P = TypeVar('P', bound=Parameters)

_hints: Callable[[Any], dict[str, Any]] = cache(get_type_hints)
"""Types of the fields of a parameter set; to resolve them takes a fifth of the time of `build`."""


def build(
        cls: type[P], section: Section, place: Place, is_rotary: bool | None = None) -> P:
    """
    Return the parameter set of a section that must hold every value without `absent`.

    If a field may hold one of several sets, its section has a key that selects one:
    ``kind: wheel``. ``is_rotary`` of the actuator chooses the units in messages; None: both.

    Raises
    ------
    ConfigError
        An unknown or missing key or kind, or values that contradict each other.
    ParameterError
        A value of the wrong type or out of range; the message has its key.

    """
    hints = _hints(cls)
    refuse_unknown_entries(section, [f.name for f in fields_of(cls)], place)
    lacking = [f.name for f in fields_of(cls)
               if f.name not in section and 'absent' not in f.metadata]
    if lacking:
        raise ConfigError(place.has(f'lacks {listed(lacking)}'))
    values: dict[str, Any] = {}
    for f in fields_of(cls):
        if f.name not in section:
            values[f.name] = f.metadata['absent']
            continue
        entry = section[f.name]
        if 'doc' in f.metadata:
            values[f.name] = _checked(entry, of_axis(f.metadata, is_rotary), place / f.name)
        elif isinstance(entry, SourcedValue):
            raise ConfigError(f'{entry.where} = {entry.value!r}, must be a section')
        elif 'named' in f.metadata:
            values[f.name] = _by_name(f.metadata['named'], entry, place / f.name)
        else:
            values[f.name] = build_one_of(hints[f.name], entry, place / f.name, is_rotary)
    try:
        return cls(**values)
    except ParameterError as error:
        raise ParameterError(f'{_last_written(section, place)}: {error}') from error


def _by_name(union: Any, section: Section, place: Place) -> Any:
    """Return the sets of a section with names of the user; as `build`."""
    named = {}
    for name, below in section.items():
        refuse_bad_name(name, f'{place / name}: the name')
        if isinstance(below, SourcedValue):
            raise ConfigError(f'{below.where} = {below.value!r}, must be a section')
        if not any(key in below for key in KIND_KEYS):
            others = [other for other in section if other != name]
            raise ConfigError(f'{_first_where(below) or place / name} lacks kind, one of '
                              f'{", ".join(members(union))}; {alternatives(name, others)}')
        named[name] = build_one_of(union, below, place / name)
    try:
        return set_by_name(named, union)
    except ConfigError as error:
        raise ConfigError(f'{place}: {error}') from error


def _last_written(section: Section, place: Place) -> Place:
    """Return the place of a section in the run file, if that has a value of it or below it."""
    for key, entry in section.items():
        if isinstance(entry, SourcedValue):
            file, _, path = entry.where.partition(': ')
            if entry.source == file and path.endswith(f'.{key}'):  # as `written` has it
                return Place(file, path.removesuffix(f'.{key}'))
        else:
            below = _last_written(entry, place / key)
            if below != place / key:
                return Place(below.file, below.key.removesuffix(f'.{key}'))
    return place


def build_one_of(
        hint: Any, section: Section, place: Place, is_rotary: bool | None = None) -> Any:
    """Return the set of a class, or of the member of a union that a section selects; `build`."""
    if isinstance(hint, type):
        return build(hint, section, place, is_rotary)
    kinds = members(hint)
    for key in KIND_KEYS:
        if key in section:
            break
    else:
        raise ConfigError(
            _last_written(section, place).has(f'lacks kind, one of {", ".join(kinds)}'))
    rest = dict(section)
    kind = rest.pop(key)
    if not isinstance(kind, SourcedValue) or str(kind.value) not in kinds:
        value = kind.value if isinstance(kind, SourcedValue) else 'a section'
        where = kind.where if isinstance(kind, SourcedValue) else str(place / key)
        raise ConfigError(f'{where} = {value!r}, must be one of {", ".join(kinds)}')
    return build(kinds[str(kind.value)], rest, _place_of(kind, place), is_rotary)


def _place_of(kind: SourcedValue, place: Place) -> Place:
    """Return the place that set the kind: a later layer with another kind must be complete."""
    file, _, key = kind.where.partition(': ')
    return place if file == place.file else Place(file, key.rpartition('.')[0])


def refuse_unknown_entries(section: Section, names: list[str], place: Place) -> None:
    """Refuse an unknown key with the place of its value, perhaps a later layer's file."""
    for key, entry in section.items():
        if key not in names:
            where = _first_where(entry)
            raise ConfigError(f'{where or place / key} is unknown; {alternatives(key, names)}')


def _first_where(entry: SourcedValue | Section) -> str:
    """Return where a value or the first value of a section was written, '' if it is empty."""
    if isinstance(entry, SourcedValue):
        return entry.where
    for below in entry.values():
        where = _first_where(below)
        if where:
            return where.rpartition('.')[0] or where
    return ''


def of_axis(declared: Mapping[str, Any], is_rotary: bool | None) -> Mapping[str, Any]:
    """Return a declaration with the unit of a linear or rotary actuator; None: with both."""
    if is_rotary is None or 'unit' not in declared:
        return declared
    return {**declared, 'unit': of_coordinate(declared['unit'], is_rotary)}


def _checked(entry: SourcedValue | Section, declared: Mapping[str, Any], place: Place) -> Any:
    if not isinstance(entry, SourcedValue):
        raise ParameterError(
            f'{place} is a section, must be one value{after(" in ", declared.get("unit", ""))}')
    check(entry.where, entry.value, declared)
    if 'names' in declared or 'is_name' in declared:
        return entry.value
    if isinstance(entry.value, list):
        return tuple(float(one) for one in entry.value)
    return float(entry.value)  # type: ignore[arg-type]


def as_tree(parameters: Parameters, hint: Any = None) -> Tree:
    """
    Return a parameter set as sections of plain values, the inverse of `written` and `build`.

    ``hint`` is the type it was declared with; for a union the section has the key of its kind.
    """
    tree: Tree = {}
    if hint is not None and not isinstance(hint, type):
        tree['kind'] = kind_of(parameters, hint)
    hints = _hints(type(parameters))
    for f in fields_of(type(parameters)):
        value = getattr(parameters, f.name)
        is_set = isinstance(value, Parameters)
        tree[f.name] = (as_tree(value, hints[f.name]) if is_set
                        else list(value) if isinstance(value, tuple) else value)
    return tree


def kind_of(parameters: Parameters, union: Any) -> str:
    """Return the kind of a parameter set that is a member of a union."""
    return next(kind for kind, cls in members(union).items() if cls is type(parameters))


def members(union: Any) -> dict[str, type[Parameters]]:
    """
    Return the classes of a union by their kind: `Parameters.KIND`, or the name in small letters.

    A last word that all of them share is left out: LinearPlant | RotaryPlant are linear
    and rotary.
    """
    classes = get_args(union) or (union,)
    words = {cls: re.findall('[A-Z][a-z0-9]*', cls.__name__) for cls in classes}
    if len(classes) > 1 and len({w[-1] for w in words.values()}) == 1:
        words = {cls: w[:-1] for cls, w in words.items()}
    return {cls.KIND or '_'.join(w).lower(): cls for cls, w in words.items()}
