"""What the numbers of a saved state may be, as runs of numbers of one kind."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from isa_ros.actuator.link import LARGEST_OF_LINE, LINK_STATE
from isa_ros.actuator.saved_ranges import LARGEST
from isa_ros.core.saved_state import TIME_BYTES
from isa_ros.core.signals import COMMAND, GAINS_OF_COMMAND, Records
import numpy as np

FINITE = -1
"""In place of the largest number: a float, which must be finite."""
GAIN = -2
"""A float that may be NaN too."""


class Check(NamedTuple):
    """Numbers in a row that have the same range."""

    at: int
    """Bytes from the begin of the state."""
    length: int
    """Of how many numbers."""
    size: int
    """Of a number, bytes."""
    largest: int
    """Of whole numbers; the smallest is 0. Else `FINITE` or `GAIN`."""
    first: str
    """Name of the first number."""


def checks(parts: Iterable[tuple[str, Records]], at: int = TIME_BYTES) -> list[Check]:
    """Return the checks of parts of a state without gaps between them, from a byte on."""
    found: list[Check] = []
    for name, rows in parts:
        for row in range(len(rows)):
            for own in _numbers(rows.dtype, at + row * rows.itemsize, name):
                last = found[-1] if found else None
                if last is not None and own[2:4] == last[2:4] and (
                        own.at == last.at + last.length * last.size):
                    found[-1] = last._replace(length=last.length + own.length)
                else:
                    found.append(own)
        at += rows.nbytes
    return found


def _numbers(dtype: np.dtype[Any], at: int, part: str) -> Iterator[Check]:
    """Yield the numbers of a record that are checked."""
    whole: Mapping[str, int] = LARGEST
    if dtype == LINK_STATE:
        whole = {f'{line}.{field}': most for line in ('down', 'up')
                 for field, most in LARGEST_OF_LINE.items()}
    for field, own, place in _fields(dtype, ''):
        count = own.itemsize // own.base.itemsize
        largest = whole.get(field)
        if own.base.kind == 'f':
            largest = GAIN if dtype == COMMAND and field in GAINS_OF_COMMAND else FINITE
        if largest is not None:
            yield Check(at + place, count, own.base.itemsize, largest, f'{part}.{field}')


def _fields(dtype: np.dtype[Any], prefix: str) -> Iterator[tuple[str, np.dtype[Any], int]]:
    """Yield dotted name, type and place of the fields of a record that are no records."""
    fields: Mapping[str, Any] = dtype.fields or {}
    for name in fields:
        own, place = fields[name][:2]
        if own.base.names is None:
            yield f'{prefix}{name}', own, place
        else:
            for k in range(own.itemsize // own.base.itemsize):
                yield from ((field, kind, place + k * own.base.itemsize + below)
                            for field, kind, below in _fields(own.base, f'{prefix}{name}.'))
