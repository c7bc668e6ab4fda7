"""Supplies of a run file: ``supply`` for all actuators, or ``supplies`` by name."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import Key, ParameterSet, Value
from isa_ros.config.text.sections import names_at, Place, Section
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives, listed
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError
from isa_ros.surroundings.circuits.accumulator import AccumulatorPart
from isa_ros.surroundings.circuits.heat import MixedHeat
from isa_ros.surroundings.circuits.manifold import ManifoldPart, TankPart
from isa_ros.surroundings.circuits.sheet import CircuitSupply, Part
from isa_ros.surroundings.emergency_line import EMERGENCY_STOP
from isa_ros.surroundings.return_line import VolumeReturn
from isa_ros.surroundings.supply import SupplySheet

SUPPLY = 'supply'
"""Name of the supply of a run with only one."""
PRESSURE, RETURN, GAS = 'pressure', 'return_pressure', 'gas_temperature'
OIL = 'oil_temperature'
"""Signals that have a topic."""
_SUPPLY_CELSIUS = ('plant', 'thermal', 'supply_celsius')


class Sampled(NamedTuple):
    """One row of samples: of a supply, or of a part of a circuit."""

    name: str
    published: tuple[str, ...] = ()
    """Signals that have a topic at every tick."""


@frozen
class SupplyConfig:
    """One supply, and the actuators that it feeds."""

    name: str
    sheet: SupplySheet
    feeds: tuple[str, ...]
    places: tuple[str, ...] = ()
    """Of a circuit the manifold that feeds each of them."""

    @property
    def sampled(self) -> tuple[Sampled, ...]:
        """Return the rows of its samples: its own, and of a circuit one for each part."""
        has_return = isinstance(self.sheet.return_line, VolumeReturn)
        own = Sampled(self.name, (PRESSURE, RETURN) if has_return else (PRESSURE,))
        if not isinstance(self.sheet, CircuitSupply):
            return (own,)
        return (own, *(Sampled(f'{self.name}/{part}', _published_of(sheet))
                       for part, sheet in self.sheet.by_name.items()))

    def sampled_at(self, actuator: str) -> str:
        """Return the name of the row of samples with the pressure of an actuator it feeds."""
        if not self.places:
            return self.name
        return f'{self.name}/{self.places[self.feeds.index(actuator)]}'

    @property
    def feeds_written(self) -> list[str] | dict[str, list[str]]:
        """Return the actuators it feeds as a file has them: of a circuit by manifold."""
        if not self.places:
            return list(self.feeds)
        found: dict[str, list[str]] = {}
        for place, name in zip(self.places, self.feeds):
            found.setdefault(place, []).append(name)
        return found

    def feeding(self, actuators: Sequence[str]) -> 'SupplyConfig':
        """Return it for some of the actuators that it feeds."""
        kept = [k for k, name in enumerate(self.feeds) if name in actuators]
        return replace(self, feeds=tuple(self.feeds[k] for k in kept),
                       places=tuple(self.places[k] for k in kept if self.places))

    @property
    def is_warm(self) -> bool:
        """Return whether it is a circuit whose oil has the temperature of its tank."""
        return isinstance(self.sheet, CircuitSupply) and isinstance(self.sheet.heat, MixedHeat)

    @property
    def span(self) -> float:
        """Return the supply pressure above return pressure, Pa."""
        return (self.sheet.pressure_mpa - self.sheet.return_pressure_mpa) * MPA


def _published_of(part: Part) -> tuple[str, ...]:
    """Return the signals of a part of a circuit that have a topic."""
    return ((PRESSURE,) if isinstance(part, ManifoldPart)
            else (GAS,) if isinstance(part, AccumulatorPart)
            else (OIL,) if isinstance(part, TankPart) and isinstance(part.heat, MixedHeat)
            else ())


def _fed(value: Any, place: Place) -> Any:
    if isinstance(value, dict):
        return {name: tuple(names_at(own, place / name)) for name, own in value.items()}
    return tuple(names_at(value, place))


FEEDS = Key(
    'feeds', Value('list of names, or lists by manifold', _fed),
    'the names of the actuators it feeds; of a circuit by manifold',
    of=lambda supply: supply.feeds_written)
SUPPLY_KEYS = KeyTable((FEEDS,), rest=Key('sheet', ParameterSet(SupplySheet), 'the supply'))


def _supply(name: str, sheet: SupplySheet, feeds: Any, place: Place) -> SupplyConfig:
    """Return a supply with what it feeds, as a file has it; as `supplies_of`."""
    if not isinstance(sheet, CircuitSupply):
        if isinstance(feeds, dict):
            raise ConfigError(f'{place} has manifolds, must be a list of names: only a circuit '
                              'has manifolds')
        return SupplyConfig(name, sheet, feeds)
    manifolds = [part for part, own in sheet.by_name.items() if isinstance(own, ManifoldPart)]
    if not isinstance(feeds, dict):
        if len(manifolds) > 1:
            raise ConfigError(
                f'{place}: the circuit has {len(manifolds)} manifolds, must be lists by manifold, '
                f'of {", ".join(manifolds)}')
        feeds = {manifolds[0]: feeds} if manifolds else {}
    for manifold in feeds:
        if manifold not in manifolds:
            raise ConfigError(
                f'{place / manifold} is not a manifold; {alternatives(manifold, manifolds)}')
    pairs = [(place_, own) for place_, names in feeds.items() for own in names]
    return SupplyConfig(name, sheet, tuple(own for _, own in pairs),
                        tuple(place_ for place_, _ in pairs))


def supplies_of(
        values: dict[str, Any], actuators: Sequence[str],
        place: Place) -> tuple[SupplyConfig, ...]:
    """
    Return the supplies of a run file, whose values are ``supply`` or ``supplies``.

    Raises
    ------
    ConfigError
        There is neither; or as `refuse_misfed`.

    """
    if values[SUPPLY] is not None:
        return (_supply(SUPPLY, values[SUPPLY], tuple(actuators), place / SUPPLY / 'feeds'),)
    if values['supplies'] is None:
        raise ConfigError(place.has(f'lacks {SUPPLY}'))
    supplies = tuple(
        _supply(name, own['sheet'], own['feeds'], place / 'supplies' / name / 'feeds')
        for name, own in values['supplies'].items())
    refuse_misfed(supplies, actuators, place / 'supplies')
    return supplies


def refuse_unused_temperature(
        supplies: Sequence[SupplyConfig], given: Mapping[str, Section], place: Place) -> None:
    """
    Refuse a temperature of the oil that flows in where the tank of a circuit has its own  (T10).

    ``given`` are the parameters of a run file by actuator, ``place`` is that of all actuators.

    Raises
    ------
    ConfigError
        Names the key and the supply.

    """
    for supply in supplies:
        for name in supply.feeds if supply.is_warm else ():
            below: Any = given[name]
            for key in _SUPPLY_CELSIUS:
                below = below.get(key) if isinstance(below, dict) else None
            if below is not None:
                raise ConfigError(
                    f'{place / name / "parameters" / ".".join(_SUPPLY_CELSIUS)} is not used: '
                    f'{supply.name} feeds it with the oil of its tank, which has a temperature '
                    'of its own')


def refuse_misfed(
        supplies: Sequence[SupplyConfig], actuators: Sequence[str], place: Place) -> None:
    """
    Refuse supplies that do not feed every actuator exactly once, or that feed others.

    Raises
    ------
    ConfigError
        An actuator is unknown, fed twice or not fed, or the topic of a supply's pressure is that
        of another one's return pressure.

    """
    names = {own.name for supply in supplies for own in supply.sampled}
    if len(names) < sum(len(supply.sampled) for supply in supplies):
        raise ConfigError(f'{place}: a part of a circuit has the name of another supply')
    for supply in supplies:
        if supply.name == EMERGENCY_STOP:
            raise ConfigError(f'{place / EMERGENCY_STOP}: the name is taken by the lines of '
                              'emergency stops')
        taken = f'{supply.name}_return'
        if taken in names and isinstance(supply.sheet.return_line, VolumeReturn):
            raise ConfigError(
                f'{place / taken}: the return pressure of {supply.name} is published as '
                f'{taken}_pressure; choose another name')
    fed: dict[str, str] = {}
    for supply in supplies:
        where = place / supply.name / 'feeds'
        for name in supply.feeds:
            if name not in actuators:
                raise ConfigError(
                    f'{where}: {name!r} is not an actuator; {alternatives(name, actuators)}')
            if name in fed:
                raise ConfigError(f'{where}: {name!r} is already fed by {fed[name]}')
            fed[name] = supply.name
    missing = [name for name in actuators if name not in fed]
    if missing:
        verb, them = ('is', 'it') if len(missing) == 1 else ('are', 'them')
        raise ConfigError(
            f'{place}: {listed([repr(name) for name in missing])} {verb} not fed; add {them} to '
            'the feeds of one of them')
