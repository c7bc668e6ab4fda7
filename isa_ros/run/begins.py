"""
When what a device counts began, as far as its bag has it.

The messages of a device tell of a count up to a second late: at its next change of state or
warnings, or at the next full second. What is counted are commands, and the bag has each of them
with its tick.
"""

from collections.abc import Iterator, Mapping, Sequence
import math
from typing import NamedTuple

from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.device import ENABLED, INITIALISING
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_QUICK_STOP, HAS_REFERENCE, HAS_SETPOINT, Records, WAS_REFUSED)
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError, SetpointError
from isa_ros.run.events import Begin, LARGEST_CAVITY, NONE, REQUESTS, SETPOINTS
from msg_adapters import diagnostics
from msg_adapters.actuator_messages import APPLIED_SETPOINT, DEVICE
from msg_adapters.cdr import CdrError
from msg_adapters.setpoint import applied_kinds
import numpy as np


class _Window(NamedTuple):
    """The messages of a device between which a count began."""

    begin: Begin
    told: float
    """What the later one says."""
    is_known: bool
    """Whether the state between them is that of the earlier one."""
    is_followed: bool | None
    """Whether the device followed setpoints between them; None: it is not known."""


class _Command(NamedTuple):
    """A command by which a count may have risen, at most by ``most``."""

    tick: int
    most: int
    is_counted: bool
    """Whether it certainly has."""


def begins_of(
        bag: Bag, run: RunConfig, ticks: Sequence[int], samples: Records
        ) -> dict[tuple[int, str], Begin]:
    """
    Return where counts began, by row and field: those that their messages tell of too late.

    ``samples`` are those of the messages of the devices, (n, n_actuators), at ``ticks``.

    Raises
    ------
    BagError
        A message is not an applied setpoint.

    """
    found = {(row, field): window for row in range(len(run.actuators)) for field in NONE
             if (window := _window(field, row, samples, ticks, run)) is not None}
    counted = {key: window for key, window in found.items() if key[1] != LARGEST_CAVITY}
    begins = {key: window.begin for key, window in found.items()}
    if counted:
        kinds = _kinds(bag, run, counted)
        for (row, field), window in counted.items():
            begins[row, field] = _narrowed(window, list(_commands(field, window, kinds[row])))
    return begins


def _window(field: str, row: int, samples: Records, ticks: Sequence[int], run: RunConfig
            ) -> _Window | None:
    """Return the window of a count of one actuator; None: none began, or its tick is known."""
    has_begun = samples[:, row][field] > NONE[field]
    k = int(np.argmax(has_begun)) if len(ticks) else 0
    if not k:
        return None
    before, now = samples[k - 1:k + 1, row]
    late = math.ceil(float(before['age']) * NS_PER_SECOND / run.step_ns)
    begin = Begin(max(ticks[k - 1] + 1 - late, 0), ticks[k])
    if begin.first == begin.last:
        return None
    is_known = not late and _has_all(run, run.actuators[row].name)
    return _Window(begin, float(now[field]), is_known, _follows(before) if is_known else None)


def _follows(sample: np.void) -> bool | None:
    """Return whether a device follows setpoints; None: a hold or its end may keep it from that."""
    state = int(sample['device_state'])
    if state == ENABLED and not sample['last_trip']:
        return True
    return None if state in (ENABLED, INITIALISING) else False


def _has_all(run: RunConfig, name: str) -> bool:
    """Return whether a bag has a message at every change of an actuator's device."""
    return any(run.record.period(topic) == 1 for topic in (
        f'/{name}/{DEVICE[0]}', diagnostics.TOPIC[0]))


def _kinds(bag: Bag, run: RunConfig, windows: Mapping[tuple[int, str], _Window]
           ) -> dict[int, dict[int, int]]:
    """Return the kinds of the applied commands by row and tick, as far as windows reach."""
    names = [own.name for own in run.actuators]
    found: dict[int, dict[int, int]] = {row: {} for row, _ in windows}
    rows = {f'/{names[row]}/{APPLIED_SETPOINT[0]}': row for row in found}
    first, last = (bound(getattr(own.begin, name) for own in windows.values())
                   for bound, name in ((min, 'first'), (max, 'last')))
    for message in bag.messages(rows):
        if message.sequence > last:
            break
        if message.sequence >= first:
            row = rows[message.topic]
            try:
                found[row][message.sequence] = applied_kinds(message.data, names[row])
            except (CdrError, SetpointError) as error:
                raise BagError(f'{bag.place_of(message)}: {error}') from error
    return found


def _commands(
        field: str, window: _Window, kinds: Mapping[int, int]) -> Iterator[_Command]:
    """Yield the commands in a window by which a count may have risen, in the order of time."""
    first, last = window.begin
    for tick, own in kinds.items():
        if not first <= tick <= last:
            continue
        if field == SETPOINTS and own & (HAS_SETPOINT | HAS_REFERENCE):
            is_followed = window.is_followed if tick < last else None
            if not is_followed:
                yield _Command(tick, 1, is_followed is False)
        if field == REQUESTS:
            bits = [own & kind != 0 for kind in (HAS_CLEAR_FAULT, HAS_QUICK_STOP, WAS_REFUSED)]
            if any(bits):
                yield _Command(tick, bits.count(True), bits[-1] or window.is_known)


def _narrowed(window: _Window, commands: Sequence[_Command]) -> Begin:
    """
    Return where a count began: at one of the commands of its window.

    No later than the first that is certainly counted, and so early that the rest can make the
    count. Of commands that are too few for it, as several that arrived over a link in one tick,
    nothing is known.
    """
    last, rest = window.begin.last, 0
    for own in reversed(commands):
        rest, last = rest + own.most, own.tick
        if rest >= window.told:
            break
    else:
        return window.begin
    counted = (own.tick for own in commands if own.is_counted)
    return Begin(commands[0].tick, min(last, next(counted, last)))
