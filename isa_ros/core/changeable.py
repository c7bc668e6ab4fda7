"""
Parameters that may change during a run: a fault is a change of such a parameter over time.

Those marked ``changeable`` in their declaration, by the dotted key and in the unit of `isa
params`; a new fault needs such a mark, and nothing else. Declared by `fault`, a parameter is
changeable and 0 in a sound device.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from typing import Any, NamedTuple, TypeVar

from isa_ros.core.parameter import check, Parameters, with_value
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError

P = TypeVar('P', bound=Parameters)


class Changeable(NamedTuple):
    """One parameter that may change during a run, as its sheet has it."""

    name: str
    """Its dotted key."""
    value: float
    unit: str
    bounds: Mapping[str, float]
    doc: str
    declared: Mapping[str, Any]


def changeables(parameters: Parameters, prefix: str = '') -> dict[str, Changeable]:
    """Return the changeable parameters of a set by key; ``prefix`` is in front of each."""
    return {own.name: own for own in _marked(parameters, prefix)}


def _marked(parameters: Parameters, prefix: str) -> Iterator[Changeable]:
    for f in fields(parameters):
        value, name, declared = getattr(parameters, f.name), f'{prefix}{f.name}', f.metadata
        if isinstance(value, Parameters):
            yield from _marked(value, f'{name}.')
        elif 'changeable' in declared:
            yield Changeable(
                name, value, declared['unit'], declared['bounds'], declared['doc'], declared)


def sound(parameters: P) -> P:
    """Return a set without faults: every `fault` is 0; the same object if there is none."""
    found = {}
    for f in fields(parameters):
        value: Any = getattr(parameters, f.name)
        if isinstance(value, Parameters):
            without: Any = sound(value)
        else:
            without = 0.0 if 'is_fault' in f.metadata else value
        if without is not value and without != value:
            found[f.name] = without
    return replace(parameters, **found) if found else parameters


def with_changes(parameters: P, values: Mapping[str, float], prefix: str = '') -> P:
    """
    Return a set with other values of its `changeables`.

    Raises
    ------
    ConfigError
        A key is unknown.
    ParameterError
        A value is out of its range, or contradicts another one.

    """
    known = changeables(parameters, prefix)
    changed = parameters
    for name, value in values.items():
        if name not in known:
            raise ConfigError(f'{name} is unknown; {alternatives(name, known)}')
        check(name, value, known[name].declared)
        if value == known[name].value:
            continue
        try:
            changed = with_value(changed, name.removeprefix(prefix).split('.'), float(value))
        except ParameterError as error:
            raise ParameterError(f'{name}: {error}') from error
    return changed
