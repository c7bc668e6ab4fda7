"""Prepared messages: encoded once, then only their numbers change."""

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate, pairwise
from operator import itemgetter
import struct

from msg_adapters.cdr import CdrError, encode_with_slots, Message

NS_PER_SECOND = 1_000_000_000
Fields = Mapping[str, int]
"""Field path -> index into the values of `Template.pack`."""

STAMP: Fields = {'header.stamp.sec': 0, 'header.stamp.nanosec': 1}
"""Paths of a header's stamp when (sec, nanosec) are the first two values."""


class Template:
    """
    Several messages that share one set of values, packed by one call of struct.

    Every message is encoded once; the constant bytes between the fields that change become
    string arguments of one struct format. Layout cannot change: arrays keep their length.

    Raises
    ------
    CdrError
        a field path that the message does not have, naming those it has.

    """

    def __init__(self, messages: Sequence[tuple[Message, Fields]], n_values: int) -> None:
        format_ = '<'
        constants: list[bytes] = []
        order: list[int] = []
        sizes: list[int] = []
        for message, fields in messages:
            data, slots = encode_with_slots(message)
            sizes.append(len(data))
            end = 0
            for path in sorted(fields, key=lambda path: _offset(message, slots, path)):
                offset, code = slots[path]
                format_ += f'{offset - end}s{code}'
                order += [n_values + len(constants), fields[path]]
                constants.append(data[end:offset])
                end = offset + struct.calcsize(f'<{code}')
            format_ += f'{len(data) - end}s'
            order.append(n_values + len(constants))
            constants.append(data[end:])
        self._constants = tuple(constants)
        self._arguments: Callable[[tuple[object, ...]], tuple[object, ...]] = itemgetter(*order)
        self._pack = struct.Struct(format_).pack
        self._slices = [slice(a, b) for a, b in pairwise(accumulate(sizes, initial=0))]
        self.n_values = n_values

    def pack(self, values: tuple[float, ...]) -> list[bytes]:
        """Return the CDR bytes of every message; ``values`` has shape (n_values,)."""
        data = self._pack(*self._arguments(values + self._constants))
        return [data[part] for part in self._slices]


def stamp(t_ns: int) -> tuple[int, int]:
    """Return (sec, nanosec) of integer nanoseconds; no float ever touches time."""
    return divmod(t_ns, NS_PER_SECOND)


def _offset(message: Message, slots: Mapping[str, tuple[int, str]], path: str) -> int:
    if path not in slots:
        raise CdrError(
            f'{type(message).__name__} has no number {path!r}; it has {", ".join(slots)}')
    return slots[path][0]
