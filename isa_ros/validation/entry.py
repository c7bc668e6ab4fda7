"""
One value beside ours, and the verdict.

An entry states its source. `PAPER`: a printed number, range or bound, beside what a simulation
gives, in an interval from the paper's own precision: printed digits, "approximately", the bound.
`WORDS`: a comparison that the paper has in words, beside a simulation, judged by its direction.
`INPUT`: a printed value that the actuators are built on, read back through the equations that use
it; so it guards the equations, and says nothing about the behaviour. `OWN`: our own target, a
regression check, also of a quantity that the paper speaks of, where the interval is ours.
"""

from collections.abc import Callable
import math
import re
import textwrap

from isa_ros.core.frozen import frozen
from isa_ros.paper.printed import Printed
from matplotlib.figure import Figure

TABLE_4, RETUNED = 'table_4', 'default'     # gains
PAPER, WORDS, INPUT, OWN = 'paper', 'words', 'input', 'own'
SOURCES = (PAPER, WORDS, INPUT, OWN)
REACHED = 'reached'
AS_READ = 'as read, not as printed'
NOT_REACHED = 'not reached'
REGRESSION = 2.0    # percent
_LETTERS = 14       # of a title, to an inch of the figure
_READING = re.compile(r'(?:erratum|errata) \d+(?:(?:, | and )\d+)*: \S')


@frozen(kw_only=True)
class Entry:
    """
    One check; ``tolerance`` is the interval (lowest, highest) that ours must lie in.

    ``paper`` is the printed value, or a text if the paper gives no number. If that value lies
    outside the tolerance, ``reading`` is how it is read: ``erratum 13: ...``.

    Raises
    ------
    ValueError
        The source is unknown, the interval is empty or contains every value, or a contradiction
        with the paper has no reading.

    """

    name: str
    source: str
    """`PAPER`, `WORDS`, `INPUT` or `OWN`."""
    where: str
    """Place in the paper, or what else the entry is compared with."""
    paper: float | str
    ours: float
    unit: str
    tolerance: tuple[float, float]
    tolerance_source: str
    reading: str = ''
    reason: str = ''
    """The cause, shown only for a value that is not reached."""
    gains: str = ''
    """The preset that was simulated, where an entry is measured with more than one."""
    is_choice: bool = False
    """Whether ``reading`` is one of several that the print allows, chosen by this very value."""

    def __post_init__(self) -> None:
        lowest, highest = self.tolerance
        if self.source not in SOURCES:
            raise ValueError(f'{self.name}: source {self.source!r}, must be one of {SOURCES}')
        if not lowest <= highest:
            raise ValueError(f'{self.name}: tolerance {self.tolerance} contains no value')
        if math.isinf(lowest) and math.isinf(highest):
            raise ValueError(f'{self.name}: tolerance {self.tolerance} contains every value')
        if self.reading and not _READING.match(self.reading):
            raise ValueError(f'{self.name}: reading {self.reading!r}, must begin with erratum N: ')
        if self.is_choice and not self.reading:
            raise ValueError(f'{self.name}: a choice among readings, must have a reading')
        if not self.reading and self._contradicts:
            raise ValueError(
                f'{self.name}: {self.paper:g} {self.unit} of the paper is outside the tolerance '
                f'{self.tolerance}, must have a reading')

    @classmethod
    def of(
            cls, name: str, printed: Printed, ours: float, tolerance: tuple[float, float],
            tolerance_source: str, *, source: str = PAPER, unit: str = '', reading: str = '',
            reason: str = '', gains: str = '', is_choice: bool = False) -> 'Entry':
        """Return the entry of a statement in the paper's data; words need the unit of ours."""
        return cls(
            name=name, source=source, where=printed.where,
            paper=printed.text if printed.value is None or printed.is_bound else printed.value,
            ours=ours,
            unit=unit or printed.unit, tolerance=tolerance, tolerance_source=tolerance_source,
            reading=reading, reason=reason, gains=gains, is_choice=is_choice)

    @classmethod
    def given(
            cls, name: str, printed: Printed, ours: float, tolerance: tuple[float, float],
            tolerance_source: str, *, unit: str = '', reading: str = '', reason: str = '',
            gains: str = '') -> 'Entry':
        """Return the entry of a printed value that the actuators are built on, as `of`."""
        return cls.of(name, printed, ours, tolerance, tolerance_source, source=INPUT, unit=unit,
                      reading=reading, reason=reason, gains=gains)

    @property
    def key(self) -> str:
        """Return the name within the group, with the gains where there are several."""
        return f'{self.name}.{self.gains}' if self.gains else self.name

    @property
    def _contradicts(self) -> bool:
        lowest, highest = self.tolerance
        return isinstance(self.paper, float) and not lowest <= self.paper <= highest

    @property
    def is_read_otherwise(self) -> bool:
        """Return whether the value is held against a reading, and not against the print."""
        return self.source != OWN and (self.is_choice or self._contradicts)

    @property
    def is_reached(self) -> bool:
        """Return whether ours lies in the tolerance; a NaN does not."""
        lowest, highest = self.tolerance
        return lowest <= self.ours <= highest

    @property
    def verdict(self) -> str:
        """Return `REACHED`, `AS_READ` if the value was read otherwise, or `NOT_REACHED`."""
        if not self.is_reached:
            return NOT_REACHED
        return AS_READ if self.is_read_otherwise else REACHED


@frozen(kw_only=True)
class Observation:
    """A value of ours beside words of the paper that name no bar: it has no verdict."""

    name: str
    where: str
    paper: str
    ours: float
    unit: str
    how: str
    """How it was observed."""


@frozen
class Drawing:
    """A figure like one of the paper's; ``name`` is part of its file's name."""

    name: str
    caption: str
    figure: Figure

    def titled(self) -> Figure:
        """Return the figure with the caption above it, for where it is shown alone."""
        width = round(_LETTERS * self.figure.get_figwidth())
        self.figure.suptitle(textwrap.fill(self.caption, width), fontsize='small')
        return self.figure


@frozen
class Findings:
    """The results of one group."""

    entries: tuple[Entry, ...]
    drawings: tuple[Drawing, ...] = ()
    observations: tuple[Observation, ...] = ()


@frozen
class CheckGroup:
    """A group of checks; ``check`` is a function of a module, so that a worker can call it."""

    name: str
    title: str
    check: Callable[..., Findings]
    """Without arguments; a group that `sensitivity` runs also takes `Actuators`."""
    is_long: bool = False
    """True if it takes more than a few seconds: it then starts first."""


def regression(
        name: str, where: str, ours: float, expected: float, unit: str, gains: str) -> Entry:
    """Return an entry that holds a value of ours, of which the paper has none, to 2 %."""
    return Entry(
        name=f'{name}_regression', source=OWN, where=where, paper='no such number', ours=ours,
        unit=unit, tolerance=around(expected, percent=REGRESSION), gains=gains,
        tolerance_source=f'regression: {REGRESSION:g} % of the value of the shipped parameters')


def around(value: float, *, by: float = 0.0, percent: float = 0.0) -> tuple[float, float]:
    """Return the interval of ``value`` plus and minus ``by`` and ``percent`` of it."""
    width = by + abs(value) * percent / 100.0
    return value - width, value + width


def as_printed(printed: Printed) -> tuple[float, float]:
    """Return the interval of a printed value: plus and minus half of its last printed digit."""
    return around(printed.number, by=printed.half_digit)


def at_least(value: float) -> tuple[float, float]:
    """Return the interval from ``value`` on."""
    return value, math.inf


def at_most(value: float) -> tuple[float, float]:
    """Return the interval up to ``value``."""
    return -math.inf, value
