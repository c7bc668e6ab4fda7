"""
Levels, delays and reactions of the conditions that the REU watches.

Most levels are parts of a rating of the actuator's own sheet, so that they hold for every bore,
valve and supply. The defaults are outside of what the shipped scenarios reach.
"""

from dataclasses import dataclass, fields
from typing import Any, Protocol

from isa_ros.core.conditions import BITS, CONDITIONS, REACTIONS
from isa_ros.core.parameter import choice, parameter, Parameters, section
from isa_ros.errors import ParameterError

_ASSUMED = 'assumed'
_STOPPING = tuple(name for name in REACTIONS if name != 'limit')
_TIMEOUT = ('hold', 'damp', 'disable')


def _level(
        doc: str, unit: str, absent: float, most: float, source: str = _ASSUMED) -> Any:
    return parameter(f'{doc}; 0: off', unit, absent=absent, source=source, ge=0.0, le=most)


def _delay(absent: float) -> Any:
    return parameter('time beyond a level before it counts, rounded up to whole conversions',
                     'ms', absent=absent, source=_ASSUMED, ge=0.0, le=60e3)


def _reaction(absent: str, *names: str) -> Any:
    return choice('what a trip causes; none: the condition is not watched', *names, absent=absent,
                  source=_ASSUMED)


class Levels(Protocol):
    """What every condition has but the timeouts of setpoint and link."""

    warning: float
    trip: float
    delay_ms: float
    reaction: str


@dataclass(frozen=True, kw_only=True)
class EndOfStroke(Parameters):
    """The piston or rotor is near an end of its own stroke."""

    warning: float = _level('distance, part of the stroke', '1', 0.0, 0.5)
    trip: float = _level('distance, part of the stroke', '1', 0.0, 0.5)
    delay_ms: float = _delay(0.0)
    reaction: str = _reaction('limit', *REACTIONS)


@dataclass(frozen=True, kw_only=True)
class Overspeed(Parameters):
    """The estimated speed is higher than the valve alone can cause."""

    warning: float = _level('speed over that of the valve, from its rated flow', '1', 1.0, 10.0)
    trip: float = _level('speed over that of the valve, from its rated flow', '1', 1.5, 10.0)
    delay_ms: float = _delay(10.0)
    reaction: str = _reaction('warn', *REACTIONS)


@dataclass(frozen=True, kw_only=True)
class Overload(Parameters):
    """The force sensor is near or at its end of range."""

    warning: float = _level('force over the range of its sensor', '1', 0.95, 1.0)
    trip: float = _level('force over the range of its sensor', '1', 0.0, 1.0)
    delay_ms: float = _delay(50.0)
    reaction: str = _reaction('disable', *REACTIONS)


@dataclass(frozen=True, kw_only=True)
class Overpressure(Parameters):
    """A chamber is far above the opening pressure of its relief valve."""

    warning: float = _level('pressure over the range of its sensor', '1', 0.95, 1.0)
    trip: float = _level('pressure over the range of its sensor', '1', 0.99, 1.0)
    delay_ms: float = _delay(50.0)
    reaction: str = _reaction('disable', *REACTIONS)


@dataclass(frozen=True, kw_only=True)
class Overcurrent(Parameters):
    """The amplifier's current is more than the valve can use."""

    warning: float = _level('current over the range of its sensor', '1', 0.9, 1.0)
    trip: float = _level('current over the range of its sensor', '1', 0.99, 1.0)
    delay_ms: float = _delay(20.0)
    reaction: str = _reaction('disable', *_STOPPING)


@dataclass(frozen=True, kw_only=True)
class Overtemperature(Parameters):
    """The actuator is warmer than its operating temperature, 80 celsius by paper Table 2."""

    warning: float = _level('temperature', 'celsius', 75.0, 200.0)
    trip: float = _level('temperature', 'celsius', 80.0, 200.0, 'paper Table 2')
    delay_ms: float = _delay(100.0)
    reaction: str = _reaction('disable', *_STOPPING)


@dataclass(frozen=True, kw_only=True)
class SupplyLow(Parameters):
    """The supply pressure is lower than the loops need."""

    warning: float = _level('pressure over the opening of the relief valves', '1', 0.5, 1.0)
    trip: float = _level('pressure over the opening of the relief valves', '1', 0.2, 1.0)
    delay_ms: float = _delay(10.0)
    reaction: str = _reaction('disable', *_STOPPING)


@dataclass(frozen=True, kw_only=True)
class ReliefOpen(Parameters):
    """A relief valve lets oil through; paper section 2.7: from 22 MPa on."""

    warning: float = _level('pressure over the opening of the relief valves', '1', 1.0, 2.0,
                            'paper section 2.7, they open at 22 MPa')
    trip: float = _level('pressure over the opening of the relief valves', '1', 0.0, 2.0)
    delay_ms: float = _delay(5.0)
    reaction: str = _reaction('warn', *REACTIONS)


@dataclass(frozen=True, kw_only=True)
class LoadCellImplausible(Parameters):
    """Pressures times areas, less friction and inertia, are not what the force sensor reads."""

    warning: float = _level('force over the range of its sensor', '1', 0.05, 1.0)
    trip: float = _level('force over the range of its sensor', '1', 0.1, 1.0)
    delay_ms: float = _delay(50.0)
    reaction: str = _reaction('disable', *_STOPPING)


@dataclass(frozen=True, kw_only=True)
class EncoderJump(Parameters):
    """The encoder moves further between two conversions than the piston or rotor can."""

    warning: float = _level('speed over that of the valve, from its rated flow', '1', 2.0, 1e3)
    trip: float = _level('speed over that of the valve, from its rated flow', '1', 4.0, 1e3)
    delay_ms: float = _delay(0.0)
    reaction: str = _reaction('disable', *_STOPPING)


@dataclass(frozen=True, kw_only=True)
class SpoolDeviation(Parameters):
    """The spool is not where its reference puts it after the lag of a sound valve."""

    warning: float = _level('distance over the stop of the spool', '1', 0.05, 2.0)
    trip: float = _level('distance over the stop of the spool', '1', 0.15, 2.0)
    delay_ms: float = _delay(50.0)
    reaction: str = _reaction('disable', *_STOPPING)


@dataclass(frozen=True, kw_only=True)
class Protection(Parameters):
    """What the REU watches, and its reactions."""

    switch: str = choice(
        'whether any condition is watched', 'on', 'off', absent='on', source=_ASSUMED)
    hysteresis: float = parameter(
        'part of its level by which a quantity must be back before the condition ends', '1',
        absent=0.02, source=_ASSUMED, ge=0.0, le=0.5)
    setpoint_timeout_ms: float = parameter(
        'longest time between two setpoints of an enabled actuator, counted from its first one '
        'on; 0: off', 'ms', absent=0.0, source=_ASSUMED, ge=0.0,
        le=3.6e6)
    setpoint_timeout_reaction: str = choice(
        'what follows until the next setpoint', *_TIMEOUT, absent='hold', source=_ASSUMED)
    link_lost_reaction: str = choice(
        "what follows when the link's watchdog has tripped, until the next frame", *_TIMEOUT,
        absent='hold', source=_ASSUMED)
    end_of_stroke: EndOfStroke = section(EndOfStroke)
    overspeed: Overspeed = section(Overspeed)
    overload: Overload = section(Overload)
    overpressure: Overpressure = section(Overpressure)
    overcurrent: Overcurrent = section(Overcurrent)
    overtemperature: Overtemperature = section(Overtemperature)
    supply_low: SupplyLow = section(SupplyLow)
    relief_open: ReliefOpen = section(ReliefOpen)
    load_cell_implausible: LoadCellImplausible = section(LoadCellImplausible)
    encoder_jump: EncoderJump = section(EncoderJump)
    spool_deviation: SpoolDeviation = section(SpoolDeviation)

    def __post_init__(self) -> None:
        """Refuse a warning that comes later than its trip."""
        super().__post_init__()
        for name, levels in levels_of(self).items():
            if not levels.warning or not levels.trip:
                continue
            is_above = CONDITIONS[BITS[name]].is_above
            if levels.warning > levels.trip if is_above else levels.warning < levels.trip:
                unit = {f.name: f.metadata for f in fields(levels)}[  # type: ignore[arg-type]
                    'warning']['unit']
                raise ParameterError(
                    f'{name}.warning = {levels.warning:g} {unit}, must be '
                    f'{"<=" if is_above else ">="} {name}.trip = {levels.trip:g} {unit}')


def levels_of(sheet: Protection) -> dict[str, Levels]:
    """Return the levels of every condition but the timeouts of setpoint and link, by its name."""
    return {name: getattr(sheet, name) for name in BITS if hasattr(sheet, name)}
