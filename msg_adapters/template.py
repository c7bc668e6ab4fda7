"""Messages of one layout: encoded once with changing numbers, or many read as columns."""

from collections.abc import Mapping, Sequence
import struct
from typing import NamedTuple

from msg_adapters.cdr import CdrError, ENCAPSULATION, encode_with_slots, Message, Slot
from msg_adapters.cdr_reader import decode
import numpy as np
from numpy.typing import NDArray

NS_PER_SECOND = 1_000_000_000
SEC, NANOSEC = -2, -1
"""Used instead of a column: the two halves of the time of the instant."""
START_SEC, START_NANOSEC = -4, -3
"""The same for the time at which the tick began."""

INSTANT, TICK_START, FIRST_VALUE = 0, 1, 2
"""Words of a `Template`: the two times, then the values."""


class Time(NamedTuple):
    """Used instead of a column, for the seconds of a stamp: the column whose word is the time."""

    column: int


Fields = Mapping[str, int | Time]
"""Field path -> column of the values, one half of a time, or a whole time."""

STAMP: Fields = {'header.stamp.sec': SEC, 'header.stamp.nanosec': NANOSEC}
"""Paths of a header's stamp."""
START_STAMP: Fields = {'header.stamp.sec': START_SEC, 'header.stamp.nanosec': START_NANOSEC}

Prepared = tuple[Message, Fields]
"""A message, and the fields whose numbers change."""

_STAMP_SEC = 'header.stamp.sec'
_WORD = 8  # bytes of a double, and of a time
_SECONDS = {SEC: INSTANT, START_SEC: TICK_START}
_NANOSECONDS = (NANOSEC, START_NANOSEC)


class Template:
    """
    Several messages in one block of memory, encoded once; afterwards only their numbers change.

    Doubles and times are whole words of the block: word ``places[k]`` of ``block`` is word
    ``sources[k]`` of a row of words: two times, then the values. Lengths of arrays cannot change.

    Raises
    ------
    CdrError
        the message has no such field path, or the field is neither a double nor a time.

    """

    def __init__(self, messages: Sequence[Prepared]) -> None:
        block = bytearray()
        places, sources = [], []
        starts, sizes = [], []
        for message, fields in messages:
            data, slots = encode_with_slots(message)
            block += bytes(-(len(block) + len(ENCAPSULATION)) % _WORD)
            start = len(block)
            for path, column in fields.items():
                offset = _offset(message, slots, path, column)
                if column not in _NANOSECONDS:
                    places.append((start + offset) // _WORD)
                    sources.append(_source(column))
            starts.append(start)
            sizes.append(len(data))
            block += data
        block += bytes(-len(block) % _WORD)
        self.block = np.frombuffer(block, '<u8')
        """The messages, one after another, as words; filled in place."""
        self.places, self.sources = np.array(places, np.int64), np.array(sources, np.int64)
        self.starts, self.sizes = np.array(starts, np.int64), np.array(sizes, np.int64)
        """Offset and size of each message in the bytes of the block."""
        self._bytes = memoryview(block)

    def fill(self, words: np.ndarray) -> None:
        """Write a row of words, ``<u8``, into every message."""
        self.block[self.places] = words[self.sources]

    def message(self, k: int) -> bytes:
        """Return the current CDR bytes of the ``k``-th message."""
        start = self.starts[k]
        return bytes(self._bytes[start:start + self.sizes[k]])


def stamped(prepared: Prepared, column: int) -> Prepared:
    """Return a message whose stamp is the time in the word of a column."""
    message, fields = prepared
    rest = {path: source for path, source in fields.items() if path not in STAMP}
    return message, {**rest, _STAMP_SEC: Time(column)}


def time_word(t_ns: int) -> int:
    """Return a time as the word of a stamp: seconds in the lower half, nanoseconds above."""
    sec, nanosec = stamp(t_ns)
    return nanosec << 32 | sec


def stamp(t_ns: int) -> tuple[int, int]:
    """Return (sec, nanosec) of integer nanoseconds, computed without floats."""
    return divmod(t_ns, NS_PER_SECOND)


def _source(column: int | Time) -> int:
    """Return the word that a field is filled from."""
    if isinstance(column, Time):
        return FIRST_VALUE + column.column
    return _SECONDS.get(column, FIRST_VALUE + column)


def _offset(
        message: Message, slots: Mapping[str, Slot], path: str, source: int | Time) -> int:
    """Return the offset of a field; refuse one of another kind than ``source``."""
    if path not in slots:
        raise CdrError(
            f'{type(message).__name__} has no number {path!r}; it has {", ".join(slots)}')
    slot = slots[path]
    is_nanosec = source in _NANOSECONDS
    is_sec = isinstance(source, Time) or source in _SECONDS
    expected = 'i' if is_sec else 'I' if is_nanosec else 'd'
    half = struct.calcsize('<I') if is_nanosec else 0
    if slot.code != expected or (slot.offset - len(ENCAPSULATION)) % _WORD != half:
        raise CdrError(
            f'{type(message).__name__}.{path} cannot be prepared: neither a double nor a time '
            'on a whole word')
    return slot.offset


class NumberLayout(NamedTuple):
    """Where messages of one layout have their numbers, and the bytes that all of them share."""

    record: np.dtype[np.void]
    """A field per path of a number, of the size of a message."""
    is_fixed: NDArray[np.bool_]
    """Of each byte, (size,): whether it is in no number."""
    fixed: NDArray[np.uint8]
    """The bytes that are in no number: texts, lengths of arrays, padding."""

    @classmethod
    def of(cls, first: bytes, message: type[Message]) -> 'NumberLayout | None':
        """
        Return the layout of a message; None if it has bytes that are in no field.

        Raises
        ------
        CdrError
            It is not a message of this class.

        """
        encoded, slots = encode_with_slots(decode(first, message))
        if encoded != first:
            return None
        record = np.dtype({
            'names': list(slots),
            'formats': [f'<{slot.code}' for slot in slots.values()],
            'offsets': [slot.offset for slot in slots.values()],
            'itemsize': len(first)})
        is_fixed: NDArray[np.bool_] = np.ones(len(first), bool)
        for name, slot in slots.items():
            is_fixed[slot.offset:slot.offset + record[name].itemsize] = False
        return cls(record, is_fixed, np.frombuffer(first, np.uint8)[is_fixed])

    def numbers(self, messages: NDArray[np.uint8]) -> NDArray[np.void] | None:
        """
        Return the numbers of messages, bytes (n, size), as a structured view, (n,).

        None if they differ from the first one in anything else.
        """
        if messages.shape[1] != self.record.itemsize:
            return None
        is_equal = (messages[:, self.is_fixed] == self.fixed).all()
        return messages.view(self.record)[:, 0] if is_equal else None


def number_columns(messages: Sequence[bytes], cls: type[Message]) -> NDArray[np.void] | None:
    """
    Return the numbers of messages as a structured array with a field per path, (n,).

    None if the messages differ in anything else.

    Raises
    ------
    CdrError
        The first message is not one of this class.

    """
    first = messages[0]
    layout = NumberLayout.of(first, cls)
    if layout is None or any(len(message) != len(first) for message in messages):
        return None
    return layout.numbers(np.frombuffer(b''.join(messages), np.uint8).reshape(-1, len(first)))
