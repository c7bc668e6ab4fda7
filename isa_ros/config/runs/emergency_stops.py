"""
Emergency stops of a run file: actuators that stop together, and the supplies that feed them.

::

    emergency_stops:
      legs:
        actuators: [haa, hfe, kfe]
        reactions: [disable, block]   # trips of a member that stop the group
        dumps: at_rest                # or at_once, or never
"""

from collections.abc import Mapping, Sequence
from typing import Any

from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import choice_of, Key, NAMES
from isa_ros.config.text.sections import Place
from isa_ros.core.conditions import FAULTS
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.surroundings.supply import is_dumped

KEY = 'emergency_stops'
ALL = 'all'
"""The group of a run without the key: all actuators, stopped by request alone."""
AT_REST, AT_ONCE, NEVER = 'at_rest', 'at_once', 'never'


@frozen
class EmergencyStopConfig:
    """One group of actuators that stop together."""

    name: str
    actuators: tuple[str, ...]
    reactions: tuple[str, ...] = ()
    """Of a trip of a member, which stops all."""
    dumps: str = AT_REST
    """When the dump valves of their supplies open."""


GROUP = KeyTable((
    Key('actuators', NAMES, 'the names of the actuators that stop together', None,
        'all of the run'),
    Key('reactions', NAMES, 'reactions of a trip of one of them that stop all: quick_stop, '
        'disable, block', ['disable', 'block']),
    Key('dumps', choice_of((AT_REST, AT_ONCE, NEVER)),
        'when the dump valves of the supplies that feed them open', AT_REST)))
GROUPS = NamedSections(GROUP, are_placed=True)


def emergency_stops_of(
        values: Mapping[str, Any] | None, actuators: Sequence[str],
        place: Place) -> tuple[EmergencyStopConfig, ...]:
    """
    Return the groups of a run file by its section, in its order.

    Raises
    ------
    ConfigError
        A group is empty, or has an unknown actuator or a reaction that does not stop one.

    """
    groups = []
    for name, own in (values or {}).items():
        below = place / name
        members = tuple(actuators) if own['actuators'] is None else own['actuators']
        if not members:
            raise ConfigError(f'{below / "actuators"} is empty, must name at least one actuator')
        for member in members:
            if member not in actuators:
                raise ConfigError(f'{below / "actuators"}: {member!r} is not an actuator; '
                                  f'{alternatives(member, actuators)}')
        for reaction in own['reactions']:
            if reaction not in FAULTS:
                raise ConfigError(f'{below / "reactions"}: {reaction!r}, must be of '
                                  f'{", ".join(FAULTS)}')
        groups.append(EmergencyStopConfig(name, members, own['reactions'], own['dumps']))
    return tuple(groups)


def refuse_without_dump(
        groups: Sequence[EmergencyStopConfig], supplies: Sequence[SupplyConfig],
        place: Place) -> None:
    """Raise `ConfigError` for a group that dumps at once, but whose supplies have no valve."""
    for own in groups:
        fed = [supply for supply in supplies if set(supply.feeds) & set(own.actuators)]
        if own.dumps == AT_ONCE and not any(is_dumped(supply.sheet) for supply in fed):
            raise ConfigError(
                f'{place / own.name / "dumps"} = {AT_ONCE} is not used: no dump valve is in '
                f'{", ".join(supply.name for supply in fed)}')
