"""One declaration per parameter: its unit, its range and its meaning."""

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cache
from keyword import iskeyword
import math
from typing import Any, TypeVar

from isa_ros.core.frozen import fields_of, frozen
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import after, in_si, quantity
from isa_ros.errors import ConfigError, ParameterError

SMALLEST = 1e-60
"""
Least magnitude of a number that is not 0, in any unit: far below whatever a machine has, and such
that squares and reciprocals of it are finite and not 0 in double precision.
"""

_RELATIONS: dict[str, tuple[str, Callable[[float, float], bool]]] = {
    'gt': ('>', lambda value, bound: value > bound),
    'ge': ('>=', lambda value, bound: value >= bound),
    'lt': ('<', lambda value, bound: value < bound),
    'le': ('<=', lambda value, bound: value <= bound),
}


def parameter(
        doc: str, unit: str, *, absent: float | None = None, source: str = '',
        changeable: bool = False, is_whole: bool = False, **bounds: float) -> Any:
    """
    Declare one number; ``bounds`` are any of ``gt``, ``ge``, ``lt``, ``le``.

    ``absent`` is the value where a file has none, such as a resolved configuration older than the
    parameter; ``source`` is that of this value. ``changeable``: it may change during a run, as a
    fault or a push (`isa_ros.core.changeable`). ``is_whole``: it is a number of things, a yes (1)
    or no (0), or a bit set.
    """
    declared = _declaration(doc, unit, bounds) | {'source': source}
    if is_whole:
        declared['is_whole'] = True
    if absent is not None:
        declared['absent'] = absent
    if changeable:
        declared['changeable'] = True
    return field(metadata=declared)


def fault(doc: str, unit: str, *, is_whole: bool = False, **bounds: float) -> Any:
    """
    Declare one number that is 0 in a sound device; sheets leave it out, and faults change it.

    ``is_whole`` as in `parameter`.
    """
    whole = {'is_whole': True} if is_whole else {}
    return field(default=0.0, metadata=_declaration(doc, unit, bounds) | whole | {
        'absent': 0.0, 'source': 'assumed, no fault', 'changeable': True, 'is_fault': True})


def _declaration(doc: str, unit: str, bounds: dict[str, float]) -> dict[str, Any]:
    unknown = set(bounds) - set(_RELATIONS)
    if unknown:
        raise TypeError(f'unknown bounds {sorted(unknown)}; use {sorted(_RELATIONS)}')
    in_si(unit)
    return {'doc': doc, 'unit': unit, 'bounds': bounds}


def tunable(doc: str, unit: str, *, named: str | None = None, **bounds: float) -> Any:
    """
    Declare one number that may change during a run.

    ``named`` is its name in SI, without a unit suffix; None: the name of the field.
    """
    return field(metadata=_declaration(doc, unit, bounds) | {'tunable': named or ''})


def numbers(doc: str, unit: str, *, least: int, most: int, **bounds: float) -> Any:
    """Declare ``least`` to ``most`` numbers in a list, each within ``bounds`` as `parameter`."""
    return field(metadata=_declaration(doc, unit, bounds) | {'length': (least, most)})


def choice(
        doc: str, *names: str, absent: str | None = None, source: str = '',
        numbered: tuple[str, ...] = ()) -> Any:
    """
    Declare one name out of a fixed list; ``absent`` and ``source`` as in `parameter`.

    ``numbered``: it may change during a run; messages have the place of a name in this list.
    """
    metadata: dict[str, Any] = {'doc': doc, 'unit': '', 'names': names, 'source': source}
    if absent is not None:
        metadata['absent'] = absent
    if numbered:
        metadata['changeable'] = numbered
    return field(metadata=metadata)


def name(doc: str, *, absent: str | None = None, source: str = '') -> Any:
    """Declare the name of another part of the same machine; `absent` as in `parameter`."""
    metadata: dict[str, Any] = {'doc': doc, 'unit': '', 'is_name': True, 'source': source}
    if absent is None:
        return field(metadata=metadata)
    return field(default=absent, metadata={**metadata, 'absent': absent})


def named_sets(union: Any) -> Any:
    """Declare a set of sets by names of the user, each one of a union; see `set_by_name`."""
    return field(metadata={'named': union})


@frozen(kw_only=True)
class Parameters:
    """
    Base of every parameter set: checked on construction, immutable afterwards.

    Fields are floats in the unit their declaration (and their name's suffix) states, several
    of them in a tuple, names out of a list, or nested parameter sets.

    Raises
    ------
    ParameterError
        A value is not finite, below `SMALLEST`, outside its range or not in its list.

    """

    KIND = ''
    """In a file, where it is one of several sets; '': as the class is called."""

    __slots__ = '__dict__', '__weakref__', '_text'      # beside the values, not among them

    @property
    def as_text(self) -> str:
        """Return the set as `repr`, made once: a set with other values has that of its parts."""
        text: str | None = getattr(self, '_text', None)
        if text is None:
            shown = ', '.join(f'{f.name}={text_of(getattr(self, f.name))}'
                              for f in fields_of(type(self)))
            text = f'{type(self).__qualname__}({shown})'
            object.__setattr__(self, '_text', text)
        return text

    def __getstate__(self) -> dict[str, Any]:
        """Return the values, for a copy or another process."""
        return vars(self)

    def __post_init__(self) -> None:
        for f in fields_of(type(self)):
            value = getattr(self, f.name)
            if not isinstance(value, Parameters):
                check(f'{type(self).__name__}.{f.name}', value, f.metadata)
                if isinstance(value, list):     # which could be changed
                    object.__setattr__(self, f.name, tuple(value))


class _NamedSets(Parameters):
    """A set of sets by name; another process makes its class by itself."""

    UNION: Any

    def __reduce__(self) -> tuple[Any, ...]:
        return set_by_name, (vars(self), self.UNION)


_P = TypeVar('_P', bound=Parameters)


def text_of(value: object) -> str:
    """Return a value as text; other numbers have another one, -0.0 than 0.0 and 1 than 1.0 too."""
    return value.as_text if isinstance(value, Parameters) else repr(value)


def set_by_name(named: Mapping[str, Parameters], union: Any) -> Parameters:
    """
    Return a set with one nested set a name, each of a class of ``union``.

    Raises
    ------
    ConfigError
        A name is a word of Python.

    """
    for given in named:
        if iskeyword(given):
            raise ConfigError(f'{given!r} is a word of Python, must be another name')
    return _named_class(tuple(named), union)(**named)


@cache
def _named_class(names: tuple[str, ...], union: Any) -> type[Parameters]:
    """Return the class with these fields; the same one for the same names, so that they equal."""
    return frozen(kw_only=True)(type('NamedSets', (_NamedSets,), {
        'UNION': union, '__annotations__': dict.fromkeys(names, union)}))


def defaults(cls: type[_P]) -> _P:
    """Return a set of which every value is that of ``absent``."""
    return cls(**{f.name: f.metadata['absent'] for f in fields_of(cls)})


def nested(absent: Parameters) -> Any:
    """Declare a nested set that a file may leave out; it then is ``absent``."""
    return field(default=absent, metadata={'absent': absent})


def section(cls: type[Parameters]) -> Any:
    """Declare a nested set that a file may leave out; it then has its `defaults`."""
    return nested(defaults(cls))


def replaced(parameters: _P, key: str, value: Any, where: str = '') -> _P:
    """
    Return a set with another value of one parameter, or section, by its dotted key.

    ``where`` and errors as in `replaced_together`.
    """
    return replaced_together(parameters, {key: value}, where)


def replaced_together(parameters: _P, values: Mapping[str, Any], where: str = '') -> _P:
    """
    Return a set with other values of parameters, or sections, by their dotted keys.

    They are checked together: only what they all make is refused. ``where`` is in front of the
    keys in messages.

    Raises
    ------
    ConfigError
        There is no such parameter.
    ParameterError
        A value is out of its range, or contradicts another one.

    """
    names = [f.name for f in fields_of(type(parameters))]
    found: dict[str, Any] = {}
    below: dict[str, dict[str, Any]] = {}
    for key, value in values.items():
        head, _, rest = key.partition('.')
        if head not in names:
            raise ConfigError(f'{where}{head} is unknown; {alternatives(head, names)}')
        if rest:
            below.setdefault(head, {})[rest] = value
        else:
            found[head] = value
    for head, inner in below.items():
        own = getattr(parameters, head)
        if not isinstance(own, Parameters):
            raise ConfigError(f'{where}{head} is one value, has no {next(iter(inner))}')
        found[head] = replaced_together(own, inner, f'{where}{head}.')
    return replace(parameters, **found)


def check(where: str, value: Any, declared: Any) -> None:
    """Refuse a value that breaks its declaration; the message has name, value, unit, bound."""
    if 'names' in declared:
        if value not in declared['names']:
            raise ParameterError(
                f'{where} = {value!r}, must be one of {", ".join(declared["names"])}')
        return
    if 'is_name' in declared:
        if not isinstance(value, str):
            raise ParameterError(f'{where} = {value!r}, must be a name ({declared["doc"]})')
        return
    unit = declared['unit']
    if 'length' in declared:
        least, most = declared['length']
        if not isinstance(value, (list, tuple)) or not least <= len(value) <= most:
            count = f'{least}' if least == most else f'{least} to {most}'
            raise ParameterError(
                f'{where} = {value!r}, must be a list of {count} numbers'
                f'{after(" in ", unit)}')
        for k, one in enumerate(value):
            _check_number(f'{where}[{k}]', one, declared)
        return
    _check_number(where, value, declared)


def _check_number(where: str, value: Any, declared: Any) -> None:
    unit = declared['unit']
    if isinstance(value, (list, tuple)):
        raise ParameterError(f'{where} = {value!r}, must be one value')
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ParameterError(f'{where} = {value!r}, must be a number{after(" in ", unit)}')
    if not math.isfinite(value):
        raise ParameterError(f'{where} = {quantity(str(value), unit)}, must be finite')
    if 'words' in declared:
        possible = {k: word for k, word in enumerate(declared['words'])
                    if word in declared['choices'] and k <= declared['bounds']['le']}
        if value not in possible:
            raise ParameterError(f'{where} = {value:g}, must be one of ' + ', '.join(
                f'{k} ({word})' for k, word in possible.items()))
    if 'is_whole' in declared and value != int(value):
        raise ParameterError(f'{where} = {value:g}, must be a whole number ({declared["doc"]})')
    if 0.0 < abs(value) < SMALLEST:
        raise ParameterError(
            f'{where} = {quantity(f"{value:g}", unit)}, must be 0 or at least '
            f'{quantity(f"{SMALLEST:g}", unit)} in magnitude ({declared["doc"]})')
    for name, bound in declared['bounds'].items():
        symbol, holds = _RELATIONS[name]
        if not holds(value, bound):
            raise ParameterError(
                f'{where} = {quantity(f"{value:g}", unit)}, must be {symbol} '
                f'{quantity(f"{bound:g}", unit)} ({declared["doc"]})')
