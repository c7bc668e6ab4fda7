"""
Messages of the wire as words of 4 bytes, which kernels compare and copy.

Their headers end with the tick; all records have a multiple of 8 bytes.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.run.wire import answers, steps
import numpy as np

WORD = 4
STEP_HEAD, ANSWER_HEAD = steps.HEADER_BYTES // WORD, answers.HEADER_BYTES // WORD
"""Words of the headers."""
TICK_WORDS = 2
_LOW, _HIGH = 0xFFFFFFFF, 32


def words_of(data: bytes) -> np.ndarray:
    """Return a message as words in memory of its own, aligned for its numbers of 8 bytes."""
    return np.frombuffer(data, np.uint8).copy().view(np.uint32)


@kernel
def write_tick(tick, words, end):
    """Write the tick at the end of a header of ``end`` words."""
    words[end - TICK_WORDS] = tick & _LOW
    words[end - 1] = tick >> _HIGH


@kernel
def begins_with(head, words):
    """Return whether a message begins with all words of ``head``."""
    for k in range(len(head)):
        if words[k] != head[k]:
            return False
    return True


@kernel
def copy_words(source, at, target, to, n):
    """Copy n words of a source from a place to one of a target."""
    for k in range(n):
        target[to + k] = source[at + k]


@kernel
def are_finite(values, at, n):
    """Return whether n floats from a place on are finite."""
    for k in range(at, at + n):
        if not math.isfinite(values[k]):
            return False
    return True
