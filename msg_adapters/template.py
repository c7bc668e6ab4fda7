"""Prepared messages: encoded once, then only their numbers change."""

from collections.abc import Mapping, Sequence
import struct

from msg_adapters.cdr import CdrError, ENCAPSULATION, encode_with_slots, Message, Slot
import numpy as np

NS_PER_SECOND = 1_000_000_000
SEC, NANOSEC = -2, -1
"""In place of an index: the two halves of the time."""

Fields = Mapping[str, int]
"""Field path -> index into `Template.values`, or `SEC` and `NANOSEC`."""

STAMP: Fields = {'header.stamp.sec': SEC, 'header.stamp.nanosec': NANOSEC}
"""Paths of a header's stamp."""

_WORD = 8  # bytes of a double, and of a time


class Template:
    """
    Several messages that share one set of values, written by one assignment of numpy.

    Every message is encoded once, all into one block of memory, in which doubles and times
    are whole words; nothing else can change: arrays keep their length.

    Raises
    ------
    CdrError
        a field path that the message does not have, naming those it has; a field that is
        neither a double nor a time.

    """

    def __init__(self, messages: Sequence[tuple[Message, Fields]], n_values: int) -> None:
        block = bytearray()
        places, sources = [], []
        self._slices = []
        for message, fields in messages:
            data, slots = encode_with_slots(message)
            block += bytes(-(len(block) + len(ENCAPSULATION)) % _WORD)
            start = len(block)
            for path, source in fields.items():
                offset = _offset(message, slots, path, source)
                if source != NANOSEC:
                    places.append((start + offset) // _WORD)
                    sources.append(0 if source == SEC else 1 + source)
            self._slices.append(slice(start, start + len(data)))
            block += data
        block += bytes(-len(block) % _WORD)
        self._block = np.frombuffer(block, '<u8')
        self._places, self._sources = np.array(places, np.intp), np.array(sources, np.intp)
        self._words = np.zeros(1 + n_values, '<u8')
        self._gathered = np.zeros(len(places), '<u8')
        self.values = self._words[1:].view('<f8')
        """What the next `pack` writes, (n_values,); to be filled in place."""

    def pack(self, t_ns: int) -> list[bytes]:
        """Return the CDR bytes of every message with `values`, at ``t_ns``."""
        sec, nanosec = stamp(t_ns)
        self._words[0] = nanosec << 32 | sec
        # With a mode the result goes straight into its place; no index is out of range.
        self._words.take(self._sources, out=self._gathered, mode='clip')
        self._block[self._places] = self._gathered
        data = self._block.tobytes()
        return [data[part] for part in self._slices]


def stamp(t_ns: int) -> tuple[int, int]:
    """Return (sec, nanosec) of integer nanoseconds; no float ever touches time."""
    return divmod(t_ns, NS_PER_SECOND)


def _offset(message: Message, slots: Mapping[str, Slot], path: str, source: int) -> int:
    """Return where a field stands, if it is of the kind that ``source`` fills."""
    if path not in slots:
        raise CdrError(
            f'{type(message).__name__} has no number {path!r}; it has {", ".join(slots)}')
    slot = slots[path]
    expected = {SEC: 'i', NANOSEC: 'I'}.get(source, 'd')
    half = struct.calcsize('<I') if source == NANOSEC else 0
    if slot.code != expected or (slot.offset - len(ENCAPSULATION)) % _WORD != half:
        raise CdrError(
            f'{type(message).__name__}.{path} cannot be prepared: neither a double nor a time '
            'on a whole word')
    return slot.offset
