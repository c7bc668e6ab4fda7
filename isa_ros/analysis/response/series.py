"""
The rigs that one call of `isa bode` or `isa step` measures, and their labels in the figure.

Every model or run file that is named, with the values of ``--set``; then, for each ``--versus``,
all of them again with its values in addition.
"""

from argparse import Namespace
import re
from typing import NamedTuple

from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.config.text.changes import Values, values_of
from isa_ros.errors import ConfigError

_NEXT_KEY = re.compile(r',(?=[\w.\[\]]+=)')     # between two KEY=VALUE


class Member(NamedTuple):
    """One of the rigs; its label is empty where it is the only one."""

    label: str
    rig: Rig


def members(options: Namespace) -> list[Member]:
    """
    Return the rigs that the arguments of a command name.

    Raises
    ------
    ConfigError
        One of them does not exist or does not fit, or a figure cannot have them all.

    """
    if not options.names:
        raise ConfigError('MODEL|CONFIG is missing; isa bode takes --bag BAG instead')
    common = values_of(options.set, '--set')
    sets: list[Values] = [{}, *(
        values_of(_NEXT_KEY.split(text), '--versus') for text in options.versus)]
    found = [Member(_label(name, values, options), _rig(name, {**common, **values}, options))
             for values in sets for name in options.names]
    if len(found) == 1:
        return [Member('', found[0].rig)]
    return found


def refuse_beside_a_bag(options: Namespace) -> None:
    """Refuse arguments that choose what a bag has chosen."""
    given = [*options.names, *(
        f'--{name}' for name in ('preset', 'variant', 'set', 'versus', 'load', 'position',
                                 'amplitude') if getattr(options, name))]
    if given:
        raise ConfigError(
            f'--bag {options.bag}: {", ".join(given)} cannot be chosen, it is as recorded')


def _rig(name: str, values: Values, options: Namespace) -> Rig:
    return rig(Choice(
        name=name, loop=options.loop, actuator=options.actuator, preset=options.preset,
        variants=options.variant, load=options.load, position=options.position, values=values))


def _label(name: str, values: Values, options: Namespace) -> str:
    """Return what differs between the rigs: values, and names if there are several."""
    names = [name] if len(options.names) > 1 or not values else []
    return ', '.join([*names, *(f'{key} = {value}' for key, value in values.items())])
