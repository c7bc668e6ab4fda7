"""
Parameters that may change during a run: a fault is a change of such a parameter over time.

Those marked ``changeable`` in their declaration, by the dotted key and in the unit of `isa
params`; a new fault needs such a mark, and nothing else. Declared by `fault`, a parameter is
changeable and 0 in a sound device.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from typing import Any, NamedTuple, TypeVar

from isa_ros.core.parameter import check, Parameters, replaced
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError

P = TypeVar('P', bound=Parameters)


class Changeable(NamedTuple):
    """One parameter that may change during a run, as its sheet has it."""

    name: str
    """That of its values in messages and saved states: its dotted key, of a gain another one."""
    value: float
    declared: Mapping[str, Any]
    """Meaning, unit and bounds of its values."""
    key: str
    """Its dotted path in the set."""
    scale: float = 1.0
    """One unit of the set in that of its values."""
    unit_of_set: str = ''
    """That unit where it is another one."""

    @property
    def keyed(self) -> 'Changeable':
        """Return it by its key and in the unit of the set."""
        bounds = {bound: limit / self.scale for bound, limit in self.bounds.items()}
        return Changeable(self.key, self.value / self.scale, {
            **self.declared, 'unit': self.unit_of_set or self.unit, 'bounds': bounds}, self.key)

    @property
    def unit(self) -> str:
        """Return the unit of its values."""
        return str(self.declared['unit'])

    @property
    def bounds(self) -> Mapping[str, float]:
        """Return any of ``gt``, ``ge``, ``lt``, ``le``."""
        bounds: Mapping[str, float] = self.declared['bounds']
        return bounds

    @property
    def doc(self) -> str:
        """Return its meaning."""
        return str(self.declared['doc'])


def changeables(parameters: Parameters, prefix: str = '') -> dict[str, Changeable]:
    """Return the changeable parameters of a set by key; ``prefix`` is in front of each."""
    return {f'{prefix}{key}': Changeable(f'{prefix}{key}', value, declared, key)
            for key, value, declared in marked(parameters, 'changeable')}


def marked(
        parameters: Parameters, mark: str, prefix: str = ''
        ) -> Iterator[tuple[str, float, Mapping[str, Any]]]:
    """Yield dotted key, value and declaration of the parameters with a mark."""
    for f in fields(parameters):
        value, key = getattr(parameters, f.name), f'{prefix}{f.name}'
        if isinstance(value, Parameters):
            yield from marked(value, mark, f'{key}.')
        elif mark in f.metadata:
            yield key, value, f.metadata


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


def with_changes(
        parameters: P, known: Mapping[str, Changeable], values: Mapping[str, float]) -> P:
    """
    Return a set with other values by the names of ``known``; equal values are kept as they are.

    Raises
    ------
    ConfigError
        A name is unknown.
    ParameterError
        A value is out of its range, or contradicts another one.

    """
    changed = parameters
    for name, value in values.items():
        if name not in known:
            keys = [one.key for one in known.values()]
            raise ConfigError(f'{name} is unknown; {alternatives(name, keys)}')
        own = known[name]
        check(name, value, own.declared)
        if value == own.value:
            continue
        try:
            changed = replaced(changed, own.key, value / own.scale)
        except ParameterError as error:
            raise ParameterError(f'{name}: {error}') from error
    return changed
