"""
Immutable dataclasses that cost little to define.

A start defines hundreds of them and makes instances of few; `dataclass` would compile six methods
of each, which took a fifth of a start. Here it is asked for ``__init__`` alone, at the first
instance.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, Field, field, fields, FrozenInstanceError
from functools import cache
from operator import attrgetter
from reprlib import recursive_repr
from typing import Any, overload, TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from typing_extensions import dataclass_transform
else:
    def dataclass_transform(**_: Any) -> Callable[[Any], Any]:
        """Return what leaves a decorator as it is; type checkers know the true one."""
        return lambda decorator: decorator

_T = TypeVar('_T')


fields_of: Callable[[Any], tuple[Field[Any], ...]] = cache(fields)
"""The fields of a class as `dataclasses.fields` has them, which lists them anew at each call."""


class _Initialiser:
    """The ``__init__`` of a class, made by `dataclass` when it is looked up."""

    def __init__(self, owner: type) -> None:
        self._owner = owner

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        made = _initialiser(self._owner)
        setattr(self._owner, '__init__', made)
        return made.__get__(instance, owner)


def _initialiser(own: Any) -> Any:
    """Return what `dataclass` makes for the fields of a class."""
    known = {each.name: each for each in fields(own)}
    other = type(own.__name__, (), {
        **known, '__annotations__': {name: each.type for name, each in known.items()},
        **{name: getattr(own, name) for name in ('__module__', '__post_init__')
           if hasattr(own, name)}})
    made: Any = vars(dataclass(frozen=True, repr=False, eq=False)(other))['__init__']
    made.__qualname__ = f'{own.__qualname__}.__init__'
    return made


@overload
def frozen(cls: type[_T], /) -> type[_T]: ...
@overload
def frozen(*, kw_only: bool = False, eq: bool = True) -> Callable[[type[_T]], type[_T]]: ...


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(cls: Any = None, /, *, kw_only: bool = False, eq: bool = True) -> Any:
    """
    Return a class as ``dataclass(frozen=True)`` does, with the same options.

    What inherits from it is decorated by this, too.
    """
    def decorated(own: type[_T]) -> type[_T]:
        dataclass(init=False, repr=False, eq=False, kw_only=kw_only)(own)
        methods = {'__init__': _Initialiser(own), '__repr__': _shown(own), **_immutable(own),
                   **(_compared(own) if eq else {})}
        for name, method in methods.items():
            if own.__dict__.get(name) is None:
                setattr(own, name, method)
        return own
    return decorated if cls is None else decorated(cls)


def _values(names: Iterable[str]) -> Callable[[object], tuple[Any, ...]]:
    """Return what gives the attributes of an instance."""
    *names, = names
    if len(names) > 1:
        return attrgetter(*names)
    return lambda self: tuple(getattr(self, name) for name in names)


def _shown(own: Any) -> Callable[[Any], str]:
    """Return what shows an instance."""
    names = [each.name for each in fields(own) if each.repr]
    values, shown = _values(names), ', '.join(f'{name}={{!r}}' for name in names)

    @recursive_repr()
    def __repr__(self: object) -> str:
        return f'{type(self).__qualname__}({shown.format(*values(self))})'
    return __repr__


def _compared(own: Any) -> dict[str, Callable[..., Any]]:
    """Return what compares instances."""
    values = _values(each.name for each in fields(own) if each.compare)

    def __eq__(self: object, other: object) -> bool:
        return values(self) == values(other) if type(other) is type(self) else NotImplemented

    def __hash__(self: object) -> int:
        return hash(values(self))
    return {'__eq__': __eq__, '__hash__': __hash__}


def _immutable(own: Any) -> dict[str, Callable[..., None]]:
    """Return what refuses to change an instance, or fields of one of a class that inherits."""
    known: dict[str, Field[Any]] = own.__dataclass_fields__

    def __setattr__(self: Any, name: str, value: object) -> None:
        if type(self) is own or name in known:
            raise FrozenInstanceError(f'cannot assign to field {name!r}')
        super(own, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is own or name in known:
            raise FrozenInstanceError(f'cannot delete field {name!r}')
        super(own, self).__delattr__(name)
    return {'__setattr__': __setattr__, '__delattr__': __delattr__}
