"""Patterns of topics in a run file, and the periods of those that are not of every tick."""

from collections.abc import Iterable
from fnmatch import fnmatchcase
from typing import Any

from isa_ros.config.text.sections import Place, section_at
from isa_ros.errors import ConfigError

MAX_PERIOD = 10_000    # ticks between two samples of a topic
MAX_PATTERNS = 100
MAX_PATTERN_LENGTH = 256

Periods = tuple[tuple[str, int], ...]
"""(pattern of topics, n): of every n-th tick."""


def patterns(value: Any, place: Place) -> tuple[str, ...]:
    """Return the patterns of a list; raises `ConfigError` as the others here."""
    if not isinstance(value, list):
        raise ConfigError(f'{place} = {value!r}, must be a list of topics')
    return tuple(_pattern(pattern, place) for pattern in _few(value, place))


def periods(value: Any, place: Place) -> Periods:
    """Return the periods of a section: whole numbers of ticks by pattern."""
    return tuple((_pattern(pattern, place), _period(n, place / pattern))
                 for pattern, n in _few(section_at(value, place), place).items())


def period_of(topic: str, given: Periods) -> int:
    """Return the period of a topic, ticks: that of the first pattern that fits, 1 without one."""
    return next((n for pattern, n in given if fnmatchcase(topic, pattern)), 1)


def fitting(pattern: str, topics: Iterable[str], place: Place) -> list[str]:
    """Return the topics that a pattern fits, at least one."""
    found = [topic for topic in topics if fnmatchcase(topic, pattern)]
    if not found:
        raise ConfigError(
            f'{place} = {pattern!r} matches no topic; valid: {", ".join(topics)}')
    return found


def _few(found: Any, place: Place) -> Any:
    if len(found) > MAX_PATTERNS:
        raise ConfigError(f'{place} has {len(found)} patterns, must be <= {MAX_PATTERNS}')
    return found


def _pattern(value: Any, place: Place) -> str:
    if isinstance(value, str) and value.startswith(('/', '*')) and (
            len(value) <= MAX_PATTERN_LENGTH):
        return value
    raise ConfigError(
        f'{place} = {value!r}, must be a topic like /hip/valve or a pattern like /*/valve of '
        f'<= {MAX_PATTERN_LENGTH} characters')


def _period(value: Any, place: Place) -> int:
    if type(value) is int and 2 <= value <= MAX_PERIOD:
        return value
    raise ConfigError(
        f'{place} = {value!r}, must be a whole number of ticks >= 2 and <= {MAX_PERIOD}')
