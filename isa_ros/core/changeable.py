"""
Parameters that may change during a run: a fault is a change of such a parameter over time.

Those marked ``changeable`` in their declaration, by the dotted key and in the unit of `isa
params`; a new fault needs such a mark, and nothing else. Declared by `fault`, a parameter is
changeable and 0 in a sound device. Of a `choice` that may change users give the word; messages
and saved states have its number.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

from isa_ros.core.frozen import fields_of
from isa_ros.core.parameter import check, Parameters, replaced_together
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError

P = TypeVar('P', bound=Parameters)


class Changeable(NamedTuple):
    """One parameter that may change during a run, as its sheet has it."""

    name: str
    """That of its values in messages and saved states: its dotted key, of a gain another one."""
    value: float
    """Of a choice the place of the word in `words`."""
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

    @property
    def words(self) -> tuple[str, ...]:
        """Return the words that its values number; (): it is a number."""
        words: tuple[str, ...] = self.declared.get('words', ())
        return words

    @property
    def choices(self) -> tuple[str, ...]:
        """Return those of `words` that it may be."""
        choices: tuple[str, ...] = self.declared.get('choices', ())
        return choices

    def shown(self, value: float) -> float | str:
        """Return a value as users give it: of a choice the word."""
        return self.words[int(value)] if self.words else value

    def number(self, where: str, given: Any) -> Any:
        """
        Return what a user has given as messages have it: of a choice the number of the word.

        Raises
        ------
        ParameterError
            It is not one of the `choices`; ``where`` is its key.

        """
        if not self.words or not isinstance(given, str):
            return given
        check(where, given, {'names': self.choices})
        return float(self.words.index(given))


def changeables(parameters: Parameters, prefix: str = '') -> dict[str, Changeable]:
    """Return the changeable parameters of a set by key; ``prefix`` is in front of each."""
    found = {}
    for key, value, declared in marked(parameters, 'changeable'):
        if 'names' in declared:
            words = declared['changeable']
            value, declared = float(words.index(value)), {
                'doc': declared['doc'], 'unit': '1', 'is_whole': True, 'words': words,
                'choices': declared['names'], 'bounds': {'ge': 0.0, 'le': len(words) - 1.0}}
        found[f'{prefix}{key}'] = Changeable(f'{prefix}{key}', value, declared, key)
    return found


def marked(
        parameters: Parameters, mark: str, prefix: str = ''
        ) -> Iterator[tuple[str, Any, Mapping[str, Any]]]:
    """Yield dotted key, value and declaration of the parameters with a mark."""
    for f in fields_of(type(parameters)):
        value, key = getattr(parameters, f.name), f'{prefix}{f.name}'
        if isinstance(value, Parameters):
            yield from marked(value, mark, f'{key}.')
        elif mark in f.metadata:
            yield key, value, f.metadata


def sound(parameters: P) -> P:
    """Return a set without faults: every `fault` is 0; the same object if there is none."""
    found = {}
    for f in fields_of(type(parameters)):
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

    Values that have to fit each other are checked together.

    Raises
    ------
    ConfigError
        A name is unknown.
    ParameterError
        A value is out of its range, or contradicts another one.

    """
    changed: dict[str, Any] = {}
    for name, value in values.items():
        if name not in known:
            keys = [one.key for one in known.values()]
            raise ConfigError(f'{name} is unknown; {alternatives(name, keys)}')
        own = known[name]
        check(name, value, own.declared)
        if value != own.value:
            changed[own.key] = own.shown(value / own.scale)
    if not changed:
        return parameters
    try:
        return replaced_together(parameters, changed)
    except ParameterError as error:
        raise ParameterError(f'{", ".join(changed)}: {error}') from error


def with_own_changes(parameters: P, owner: str, values: Mapping[str, float]) -> P:
    """Return a set with those of ``values`` whose name is OWNER.KEY; raises as `with_changes`."""
    prefix = f'{owner}.'
    own = {name: value for name, value in values.items() if name.startswith(prefix)}
    return with_changes(parameters, changeables(parameters, prefix), own)
