"""Supplies of a run file: ``supply`` for all actuators, or ``supplies`` by name."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from isa_ros.config.text.names import refuse_bad_name
from isa_ros.config.text.parameter_sets import build_one_of
from isa_ros.config.text.schema import KeyDifference, Names, ParameterSet
from isa_ros.config.text.sections import names_at, Place, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError
from isa_ros.surroundings.return_line import VolumeReturn
from isa_ros.surroundings.supply import SupplySheet

SUPPLY = 'supply'
"""Name of the supply of a run with only one."""


@dataclass(frozen=True)
class SupplyConfig:
    """One supply, and the actuators that it feeds."""

    name: str
    sheet: SupplySheet
    feeds: tuple[str, ...]

    @property
    def span(self) -> float:
        """Return the supply pressure above return pressure, Pa."""
        return (self.sheet.pressure_mpa - self.sheet.return_pressure_mpa) * MPA


def read_supplies(
        tree: Tree, actuators: Sequence[str], place: Place) -> tuple[SupplyConfig, ...]:
    """
    Return the supplies of a run file with the names of the actuators that they feed.

    Raises
    ------
    ConfigError
        Both forms are given, or neither; a supply is invalid, or an actuator is fed by no supply
        or by two.

    """
    if (SUPPLY in tree) == ('supplies' in tree):
        raise ConfigError(place.has(
            f'has {SUPPLY} and supplies, must have only one of them' if SUPPLY in tree else
            f'lacks {SUPPLY}'))
    if SUPPLY in tree:
        below = place / SUPPLY
        return (SupplyConfig(SUPPLY, _sheet(section_at(tree[SUPPLY], below), below),
                             tuple(actuators)),)
    below = place / 'supplies'
    supplies = tuple(
        _named(name, section_at(section, below / name), below / name)
        for name, section in section_at(tree['supplies'], below).items())
    refuse_misfed(supplies, actuators, below)
    return supplies


def _named(name: str, section: Tree, place: Place) -> SupplyConfig:
    refuse_bad_name(name, f'{place}: the name')
    rest: dict[str, Any] = dict(section)
    if 'feeds' not in rest:
        raise ConfigError(place.has('lacks feeds, the names of the actuators it feeds'))
    feeds = names_at(rest.pop('feeds'), place / 'feeds')
    return SupplyConfig(name, _sheet(rest, place), tuple(feeds))


def _sheet(section: Tree, place: Place) -> SupplySheet:
    sheet: SupplySheet = build_one_of(SupplySheet, written(section, place), place)
    return sheet


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
    names = {supply.name for supply in supplies}
    for supply in supplies:
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
    for name in actuators:
        if name not in fed:
            raise ConfigError(
                f'{place}: {name!r} is not fed; add it to the feeds of one of them')


class SupplyKind:
    """The keys of a supply's sheet, and ``feeds``; a `Section` of `SupplyConfig`."""

    cls = SupplyConfig
    _sheet = ParameterSet(SupplySheet)

    def tree(self, value: SupplyConfig) -> Tree:
        """Return the sheet's section with the names of the actuators."""
        tree = self._sheet.tree(value.sheet)
        tree['feeds'] = list(value.feeds)
        return tree

    def read(self, tree: Any, place: Place, **given: Any) -> SupplyConfig:
        """Return the supply; as `Kind.read`."""
        rest = dict(section_at(tree, place))
        feeds = Names().read(rest.pop('feeds', None), place / 'feeds')
        return SupplyConfig(sheet=self._sheet.read(rest, place), feeds=feeds, **given)

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield the keys of the sheet that differ, and ``feeds`` where it is missing."""
        if not isinstance(tree, dict):
            return
        yield from self._sheet.differences(
            {key: value for key, value in tree.items() if key != 'feeds'}, place)
        if 'feeds' not in tree:
            yield KeyDifference(f'{place / "feeds"} is missing in the bag', True)
