"""
The parts of an answer on the private wire: what a role returns of a tick.

An actuator's are its rows and the parameters that changed, a controller's the `COMMAND` rows
that it requests. What arrives is checked before any of it is taken.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
import json
import math
import struct
from typing import Any

from isa_ros.actuator.inbox import WITH_GAINS
from isa_ros.core.device import MODES
from isa_ros.core.kernel import kernel_function
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, HAS_ENABLE, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, LOAD_REPLY, Records,
    SAMPLE, SUPPLY_REPLY, WAS_REFUSED)
from isa_ros.run.wire.header import WireError
from isa_ros.tick.exchange import Rows
import numpy as np
from numpy.typing import NDArray

Parts = Sequence[bytes | None]

ABSENT = 0xFFFFFFFF
"""Length of a part that is None."""

MOST_TUNED = 1000
_LONGEST_NAME = 256
_COUNT = 4  # bytes of a length
_FLOAT = 8
_APPLIED_AT = LOAD_REPLY.itemsize + SAMPLE.itemsize
ROWS_BYTES = _APPLIED_AT + COMMAND.itemsize
"""Of an actuator's answer: reply, sample and applied command."""
PARTS = 3
"""Of an actuator's answer in a run whose supplies have no ports."""
_LAST_STEP = 2**46  # of the plant: 44 years
_N_MODES = len(MODES)


def actuator_parts(
        reply: Records, sample: Records, applied: Records,
        tuned: Mapping[str, float], sent: Records | None = None,
        fed: Records | None = None) -> list[bytes | None]:
    """
    Return the parts of an actuator's answer: its rows, and the parameters that changed.

    ``reply``, ``sample`` and ``applied`` are its `LOAD_REPLY`, `SAMPLE` and `COMMAND`, (1,);
    ``sent`` is the `COMMAND` handed to its link, (1,), where it has one, and ``fed`` its
    `SUPPLY_REPLY`, (1,), in a run whose supplies have ports.
    """
    is_sent = sent is not None and sent[0]['kinds']
    parts = [reply.tobytes() + sample.tobytes() + applied.tobytes(),
             tuned_part(tuned), sent.tobytes() if sent is not None and is_sent else None]
    return parts if fed is None else [*parts, fed.tobytes()]


def refuse_actuator_parts(parts: Parts) -> None:
    """
    Refuse parts that are not those of an actuator, or that contain a number that is not finite.

    Raises
    ------
    WireError
        They cannot be taken.

    """
    rows, tuned, sent = parts[:PARTS] if PARTS <= len(parts) <= PARTS + 1 else (None,) * PARTS
    if rows is None or len(rows) != ROWS_BYTES:
        raise WireError('an answer that is not of an actuator')
    if not is_finite(np.frombuffer(rows, np.float64, _APPLIED_AT // _FLOAT)):
        raise WireError('an answer of an actuator with a number that is not finite')
    refuse_command(np.frombuffer(rows, COMMAND, 1, _APPLIED_AT)[0], EVERY_KIND | WAS_REFUSED)
    if sent is not None:
        if len(sent) != COMMAND.itemsize:
            raise WireError('an answer with a sent setpoint that is not a command')
        refuse_command(np.frombuffer(sent, COMMAND)[0])
    if tuned is not None:
        tuned_of(tuned)
    if len(parts) > PARTS:
        fed = parts[PARTS] or b''
        if len(fed) != SUPPLY_REPLY.itemsize or not is_finite(np.frombuffer(fed, np.float64)):
            raise WireError('an answer with an invalid reply to the port of a supply')


def take_actuator_parts(parts: Parts, row: int, rows: Rows) -> None:
    """Fill one row from the parts of an actuator's answer; inverse of `actuator_parts`."""
    data, tuned, sent, *fed = parts
    assert data is not None, 'refuse_actuator_parts has checked them'
    sample_at = LOAD_REPLY.itemsize
    rows.reply_values[row] = np.frombuffer(data, np.float64, sample_at // _FLOAT)
    rows.sample_values[row] = np.frombuffer(
        data, np.float64, SAMPLE.itemsize // _FLOAT, sample_at)
    rows.applied[row] = np.frombuffer(data, COMMAND, 1, _APPLIED_AT)[0]
    rows.sent['kinds'][row] = 0
    if sent is not None:
        rows.sent[row] = np.frombuffer(sent, COMMAND)[0]
    if tuned is not None:
        rows.tuned = {**rows.tuned, row: tuned_of(tuned)}
    if fed:
        rows.fed[row] = np.frombuffer(fed[0] or b'', SUPPLY_REPLY)[0]


def tuned_part(values: Mapping[str, float]) -> bytes | None:
    """Return the part of some parameters that change; None for none."""
    return json.dumps(dict(values)).encode() if values else None


def tuned_of(data: bytes) -> dict[str, float]:
    """
    Return the parameters that change, by name; inverse of `tuned_part`.

    Raises
    ------
    WireError
        They are not finite numbers by name.

    """
    try:
        values: Any = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise WireError('a message with unreadable parameters') from error
    if not isinstance(values, dict) or len(values) > MOST_TUNED or not all(
            name.isascii() and len(name) <= _LONGEST_NAME and type(value) is float
            and math.isfinite(value) for name, value in values.items()):
        raise WireError('a message with parameters that are not finite numbers')
    return values


def refuse_requests(parts: Parts, n_actuators: int) -> None:
    """
    Refuse parts that are not the `COMMAND` rows of a controller, one for each actuator.

    Raises
    ------
    WireError
        They cannot be taken.

    """
    if len(parts) != 1 or parts[0] is None or len(parts[0]) != n_actuators * COMMAND.itemsize:
        raise WireError('an answer that is not of a controller')
    for command in np.frombuffer(parts[0], COMMAND):
        refuse_command(command)


def refuse_command(command: np.void, known: int = EVERY_KIND) -> None:
    """
    Refuse a `COMMAND` row that no actuator can execute; without a command, all are accepted.

    ``known`` are the bits that its kinds may have.

    Raises
    ------
    WireError
        A kind, a number or a gain is invalid.

    """
    if not is_valid_command(command, known):
        raise WireError('a command with an invalid kind, number or gain')


@kernel_function
def is_valid_command(command: np.void, known: int) -> bool:
    """Return whether an actuator can execute a `COMMAND` row, as `refuse_command`."""
    kinds = command['kinds']
    if kinds == 0:
        return True
    if (kinds | known) != known or not 0 <= command['due_step'] <= _LAST_STEP:
        return False
    if kinds & HAS_ENABLE and command['is_enabled'] > 1:
        return False
    if kinds & (HAS_MODE | HAS_REFERENCE) and not 0 < command['mode'] < _N_MODES:
        return False
    if kinds & HAS_REFERENCE and not math.isfinite(command['reference']):
        return False
    if kinds & HAS_SETPOINT and not (
            math.isfinite(command['position']) and math.isfinite(command['velocity'])
            and math.isfinite(command['effort'])):
        return False
    return not kinds & WITH_GAINS or (
        _is_gain(command['stiffness']) and _is_gain(command['damping']))


@kernel_function
def _is_gain(gain: float) -> bool:
    """Return whether a number is a gain; NaN keeps the one in force."""
    return not (math.isinf(gain) or gain < 0.0)


def is_finite(values: NDArray[np.float64]) -> bool:
    """Return whether all numbers are finite; in a third of the time of `ndarray.all`."""
    return b'\0' not in np.isfinite(values).tobytes()


def joined(parts: Parts) -> bytes:
    """Return the lengths of all parts, followed by the parts that are not None."""
    lengths = [ABSENT if part is None else len(part) for part in parts]
    return b''.join((_counts(len(parts)).pack(*lengths), *filter(None, parts)))


def split(data: bytes, n: int) -> list[bytes | None]:
    """
    Return the ``n`` parts that ``data`` consists of; inverse of `joined`.

    Raises
    ------
    WireError
        The lengths of the parts are not that of the data.

    """
    start = _COUNT * n
    if start > len(data):
        raise WireError(f'{n} parts in {len(data)} bytes')
    parts: list[bytes | None] = []
    for length in _counts(n).unpack_from(data):
        if length == ABSENT:
            parts.append(None)
            continue
        parts.append(data[start:start + length])
        start += length
    if start != len(data):
        raise WireError(f'parts up to byte {start} of {len(data)}')
    return parts


@lru_cache(64)
def _counts(n: int) -> struct.Struct:
    return struct.Struct(f'<{n}I')
