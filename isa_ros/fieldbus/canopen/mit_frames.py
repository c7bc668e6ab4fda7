"""
MIT-mode frames, the impedance control of electric legs: five numbers in 8 bytes.

Command: position 16 bits, velocity 12, stiffness 12, damping 12, effort 12. Answer: number of the
motor 8 bits, position 16, velocity 12, effort 12. The most significant bit is first. A number of n
bits is a linear scale from the low end of its range (all bits 0) to the high end (all bits 1). So
the zero of a symmetric range lies between two codes: the nearest is half a step of it away.
"""

from collections.abc import Sequence
from typing import NamedTuple

COMMAND_BYTES, ANSWER_BYTES = 8, 6
ENABLE, DISABLE, SET_ZERO = 0xFC, 0xFD, 0xFE
"""Last byte of a special frame, behind seven of 0xFF."""
_SPECIAL = b'\xff' * 7


class Range(NamedTuple):
    """Both ends of the scale of a number, SI."""

    low: float
    high: float


class Ranges(NamedTuple):
    """The scales of an actuator's frames."""

    position: Range
    velocity: Range
    stiffness: Range
    damping: Range
    effort: Range


class MotorCommand(NamedTuple):
    """What a command frame asks for, SI."""

    position: float
    velocity: float
    stiffness: float
    damping: float
    effort: float


class MotorAnswer(NamedTuple):
    """What a motor answers, SI."""

    motor: int
    position: float
    velocity: float
    effort: float


_COMMAND_BITS = (16, 12, 12, 12, 12)
_ANSWER_BITS = (16, 12, 12)


def special_of(data: bytes) -> int | None:
    """Return which special frame this is, None for a command."""
    is_special = data[:-1] == _SPECIAL and data[-1] in (ENABLE, DISABLE, SET_ZERO)
    return data[-1] if is_special else None


def command_of(data: bytes, ranges: Ranges) -> MotorCommand:
    """Return the command of a frame of 8 bytes."""
    return MotorCommand(*_unpacked(data, ranges, _COMMAND_BITS))


def answer_frame(answer: MotorAnswer, ranges: Ranges) -> bytes:
    """Return the frame of an answer; values beyond their ranges saturate."""
    return bytes([answer.motor]) + _packed(answer[1:], _answered(ranges), _ANSWER_BITS)


def _answered(ranges: Ranges) -> tuple[Range, Range, Range]:
    return ranges.position, ranges.velocity, ranges.effort


def _packed(values: Sequence[float], ranges: Sequence[Range], bits: Sequence[int]) -> bytes:
    word = 0
    for value, (low, high), width in zip(values, ranges, bits, strict=True):
        largest = (1 << width) - 1
        code = round((value - low) / (high - low) * largest) if high > low else 0
        word = word << width | min(max(code, 0), largest)
    return word.to_bytes(sum(bits) + 7 >> 3, 'big')


def _unpacked(data: bytes, ranges: Sequence[Range], bits: Sequence[int]) -> list[float]:
    word, left, values = int.from_bytes(data, 'big'), sum(bits), []
    for (low, high), width in zip(ranges, bits, strict=True):
        left -= width
        largest = (1 << width) - 1
        values.append(low + (word >> left & largest) * (high - low) / largest)
    return values
