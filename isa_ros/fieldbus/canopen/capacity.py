"""
What the frames of a cycle take of a CAN bus, and the refusal of those that do not fit.

A data frame of classical CAN with s bytes has 47 + 8 s bits, the 3 between frames included: start
1, identifier 11, control 7, data 8 s, check 15, and 13 that are never stuffed. After five equal
bits a stuff bit of the opposite value is sent, which may begin the next five. Identifier and
length are known, data and check are taken as those with the most stuff bits.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from isa_ros.errors import ConfigError

_FIXED = 47         # bits of a frame without data
_CHECK = 15         # bits of the check sequence
_RUN = 5            # equal bits before a stuff bit
_NS_PER_S = 1_000_000_000


class CyclicFrame(NamedTuple):
    """A frame that is sent in each cycle."""

    identifier: int
    size: int


def frame_bits(frame: CyclicFrame) -> int:
    """Return the most bits that a data frame takes of the bus."""
    stuffed, run = _header_stuffing(frame)
    free = 8 * frame.size + _CHECK
    first = _RUN - run
    if free >= first:
        stuffed += 1 + (free - first) // (_RUN - 1)
    return _FIXED + 8 * frame.size + stuffed


def cycle_bits(frames: Iterable[CyclicFrame]) -> int:
    """Return the most bits of all frames of a cycle."""
    return sum(frame_bits(frame) for frame in frames)


def refuse_overfull(
        shared: Sequence[CyclicFrame], own: Mapping[str, Sequence[CyclicFrame]],
        bitrate: int, step_ns: int) -> None:
    """
    Refuse frames that a bus does not carry in a tick.

    ``shared`` are those of all (SYNC), ``own`` those of each actuator.

    Raises
    ------
    ConfigError
        They do not fit; the message has the arithmetic and the least tick.

    """
    bits = [cycle_bits(frames) for frames in own.values()]
    common = cycle_bits(shared)
    needed, available = common + sum(bits), bitrate * step_ns / _NS_PER_S
    if needed <= available:
        return
    sync = f'SYNC {common} + ' if shared else ''
    raise ConfigError(
        f'step_ms = {step_ns / 1e6:g} ms, must be >= {1e3 * needed / bitrate:g} ms: '
        f'{len(own)} actuators ({", ".join(own)}) need {sync}{" + ".join(map(str, bits))} = '
        f'{needed} bit a tick, CAN at {bitrate / 1e6:g} Mbit/s carries {available:g} bit')


def _header_stuffing(frame: CyclicFrame) -> tuple[int, int]:
    """Return the stuff bits within start, identifier and control, and the last equal bits."""
    # start 0, identifier, then RTR, IDE and r0, all 0, and the length
    header = f'0{frame.identifier:011b}000{frame.size:04b}'
    stuffed, run, last = 0, 0, ''
    for bit in header:
        run = run + 1 if bit == last else 1
        last = bit
        if run == _RUN:
            stuffed += 1
            run, last = 1, '1' if bit == '0' else '0'
    return stuffed, run
