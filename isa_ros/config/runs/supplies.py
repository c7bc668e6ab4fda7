"""Supplies of a run file: ``supply`` for all actuators, or ``supplies`` by name."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import Key, NAMES, ParameterSet
from isa_ros.config.text.sections import Place
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError
from isa_ros.surroundings.return_line import VolumeReturn
from isa_ros.surroundings.supply import SupplySheet
from isa_ros.surroundings.surroundings import EMERGENCY_STOP

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


SUPPLY_KEYS = KeyTable(
    (Key('feeds', NAMES, 'the names of the actuators it feeds'),),
    rest=Key('sheet', ParameterSet(SupplySheet), 'the supply'))


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
        return (SupplyConfig(SUPPLY, values[SUPPLY], tuple(actuators)),)
    if values['supplies'] is None:
        raise ConfigError(place.has(f'lacks {SUPPLY}'))
    supplies = tuple(SupplyConfig(name, **own) for name, own in values['supplies'].items())
    refuse_misfed(supplies, actuators, place / 'supplies')
    return supplies


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
    for name in actuators:
        if name not in fed:
            raise ConfigError(
                f'{place}: {name!r} is not fed; add it to the feeds of one of them')
