"""Numbers of many messages of one layout as columns, without decoding each message."""

from collections.abc import Sequence

from msg_adapters.cdr import encode_with_slots, Message
from msg_adapters.cdr_reader import decode
import numpy as np
from numpy.typing import NDArray


def number_columns(messages: Sequence[bytes], cls: type[Message]) -> NDArray[np.void] | None:
    """
    Return the numbers of messages as a structured array with a field per path, (n,).

    None if the messages differ in anything else: texts, lengths of arrays, padding.

    Raises
    ------
    CdrError
        The first message is not one of this class.

    """
    first = messages[0]
    encoded, slots = encode_with_slots(decode(first, cls))
    if encoded != first or any(len(message) != len(first) for message in messages):
        return None
    record = np.dtype({
        'names': list(slots),
        'formats': [f'<{slot.code}' for slot in slots.values()],
        'offsets': [slot.offset for slot in slots.values()],
        'itemsize': len(first)})
    numbers = np.frombuffer(b''.join(messages), record)
    fixed: NDArray[np.bool_] = np.ones(len(first), bool)
    for name, slot in slots.items():
        fixed[slot.offset:slot.offset + record[name].itemsize] = False
    rest = numbers.view(np.uint8).reshape(len(messages), len(first))[:, fixed]
    return numbers if np.array_equal(rest, np.broadcast_to(rest[0], rest.shape)) else None
