"""
Levels, delays and reactions of the conditions that the REU watches, from `CONDITIONS`.

Most levels are parts of a rating of the actuator's own sheet, so that they hold for every bore,
valve and supply. The defaults are outside of what the shipped scenarios reach.
"""

from collections.abc import Iterator, Mapping
from typing import Any, get_type_hints, Protocol, TypeVar

from isa_ros.core.conditions import (
    ASSUMED, BITS, Condition, CONDITIONS, LevelDefaults, REACTIONS)
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, parameter, Parameters, section
from isa_ros.core.units import quantity
from isa_ros.errors import ParameterError

_TIMEOUT = ('hold', 'damp', 'disable', 'block')
_P = TypeVar('_P', bound=Parameters)


class Levels(Protocol):
    """The parameters of every condition but the timeouts of setpoint and link."""

    warning: float
    trip: float
    delay_ms: float
    reaction: str


def _levels(condition: Condition, own: LevelDefaults) -> type[Parameters]:
    """Return the parameter set of a condition with levels, named after it: ``SupplyLow``."""
    def level(absent: float, source: str) -> Any:
        return parameter(
            f'{own.compared}; 0: off', condition.level_unit, absent=absent, source=source,
            changeable=True, ge=0.0, le=own.most)

    declared = {
        'warning': level(own.warning, own.warning_source),
        'trip': level(own.trip, own.trip_source),
        'delay_ms': parameter(
            'time beyond a level before it counts, rounded up to whole conversions', 'ms',
            absent=own.delay_ms, source=ASSUMED, changeable=True, ge=0.0, le=60e3),
        'reaction': choice(
            'what a trip causes; none: the condition is not watched',
            *(name for name in REACTIONS if own.may_limit or name != 'limit'),
            absent=own.reaction, source=ASSUMED, numbered=REACTIONS)}
    return frozen(kw_only=True)(type(
        condition.name.title().replace('_', ''), (Parameters,),
        {'__doc__': condition.meaning, '__annotations__': get_type_hints(Levels), **declared}))


LEVELS: Mapping[str, type[Parameters]] = {
    condition.name: _levels(condition, condition.levels)
    for condition in CONDITIONS if condition.levels is not None}
"""The parameter set of each condition that has levels, by its name."""


def __getattr__(name: str) -> type[Parameters]:
    """Return a set of `LEVELS` by the name of its class, with which pickle looks for it."""
    for levels in LEVELS.values():
        if levels.__name__ == name:
            return levels
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')


def _with_levels(cls: type[_P]) -> type[_P]:
    """Add the sets of `LEVELS` to a parameter set, each under its name."""
    for name, levels in LEVELS.items():
        cls.__annotations__[name] = levels
        setattr(cls, name, section(levels))
    return cls


@frozen(kw_only=True)
@_with_levels
class Protection(Parameters):
    """What the REU watches, and its reactions."""

    switch: str = choice(
        'whether any condition is watched', 'on', 'off', absent='on', source=ASSUMED)
    hysteresis: float = parameter(
        'part of its level by which a quantity must be back before the condition ends', '1',
        absent=0.02, source=ASSUMED, changeable=True, ge=0.0, le=0.5)
    mask: float = parameter(
        'conditions that are not watched, the sum of 1 << bit of each; 0: none', '1',
        absent=0.0, source=ASSUMED, changeable=True, is_whole=True, ge=0.0,
        le=float((1 << len(CONDITIONS)) - 1))
    setpoint_timeout_ms: float = parameter(
        'longest time between two setpoints of an enabled actuator, counted from its first one '
        'on; at least a tick, 0: off', 'ms', absent=0.0, source=ASSUMED, changeable=True,
        ge=0.0, le=3.6e6)
    setpoint_timeout_reaction: str = choice(
        'what follows until the next setpoint', *_TIMEOUT, absent='hold', source=ASSUMED,
        numbered=REACTIONS)
    link_lost_reaction: str = choice(
        "what follows when the link's watchdog has tripped, until the next frame", *_TIMEOUT,
        absent='hold', source=ASSUMED, numbered=REACTIONS)
    watchdog_reaction: str = choice(
        "what follows when the REU's watchdog has switched its output off, until it is cleared",
        'disable', absent='disable', source=ASSUMED)

    def __post_init__(self) -> None:
        """Refuse a warning that comes later than its trip, and reactions that make it worse."""
        super().__post_init__()
        for name, levels in levels_of(self).items():
            own = CONDITIONS[BITS[name]].levels
            if own is not None and levels.reaction in own.refused:
                possible = [one for one in REACTIONS if one not in own.refused
                            and (own.may_limit or one != 'limit')]
                raise ParameterError(
                    f'{name}.reaction = {levels.reaction}, must be {" or ".join(possible)}: '
                    f'{own.why_refused}')
            if not levels.warning or not levels.trip:
                continue
            condition = CONDITIONS[BITS[name]]
            is_above, unit = condition.is_above, condition.level_unit
            if levels.warning > levels.trip if is_above else levels.warning < levels.trip:
                raise ParameterError(
                    f'{name}.warning = {quantity(f"{levels.warning:g}", unit)}, must be '
                    f'{"<=" if is_above else ">="} {name}.trip = '
                    f'{quantity(f"{levels.trip:g}", unit)}')


def levels_of(sheet: Protection) -> dict[str, Levels]:
    """Return the levels of every condition but the timeouts of setpoint and link, by its name."""
    return {name: getattr(sheet, name) for name in LEVELS}


CONDITION_OF = {
    f'{name}.reaction' if name in LEVELS else f'{name}_reaction': name for name in BITS}
"""Condition by the key of its reaction below ``reu.protection``."""


def reactions_of(sheet: Protection) -> dict[str, str]:
    """Return the reaction of every condition by its key below ``reu.protection``."""
    return {key: reaction_of(sheet, name) for key, name in CONDITION_OF.items()}


def changed_reactions(values: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    """Yield condition and reaction for each reaction among changed values, by their names."""
    for name, value in values.items():
        condition = CONDITION_OF.get(name.partition('reu.protection.')[2])
        if condition is not None:
            yield condition, REACTIONS[int(value)]


def reaction_of(sheet: Protection, condition: str) -> str:
    """Return the reaction to the trip of a condition."""
    if condition in LEVELS:
        return levels_of(sheet)[condition].reaction
    found: str = getattr(sheet, f'{condition}_reaction')
    return found
