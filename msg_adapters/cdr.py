"""
Canonical CDR: a unique byte string for each message.

XCDR1, little endian, as ROS 2 middlewares write it, with every padding byte zero:
``rclpy.serialize_message`` leaves padding uninitialised, which is not possible in bags that are
compared byte by byte. Alignment counts from the end of the 4-byte encapsulation header; an
empty sequence does not align its (absent) elements.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache
import re
import struct
from typing import Any, NamedTuple, Protocol

from isa_ros.errors import IsaError
import numpy as np

ENCAPSULATION = b'\x00\x01\x00\x00'  # CDR_LE, no options
PRIMITIVES = {
    'boolean': '?', 'octet': 'B', 'char': 'B', 'int8': 'b', 'uint8': 'B',
    'int16': 'h', 'uint16': 'H', 'int32': 'i', 'uint32': 'I',
    'int64': 'q', 'uint64': 'Q', 'float': 'f', 'double': 'd',
}
"""Field type of a message class -> struct format character; the size is the alignment."""

_SEQUENCE = re.compile(r'sequence<(.+?)(?:, \d+)?>')
_ARRAY = re.compile(r'(.+)\[(\d+)\]')
_STRING = re.compile(r'string(<\d+>)?')
_LENGTH = struct.Struct('<I')     # of strings and sequences; the encapsulation header has its size
_DECLARATIONS = 1024    # of fields that are remembered: encoding a message reads each again


class CdrError(IsaError):
    """A message cannot be encoded, or bytes are not a message of their type."""


class Message(Protocol):
    """Interface of the generated Python classes of ROS 2 messages."""

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return the field types by field name, in wire order."""


class FieldType(NamedTuple):
    """Type of one field: its element type and number of elements."""

    item: str
    is_sequence: bool
    length: int | None  # of a fixed array


class Slot(NamedTuple):
    """Offset of one primitive in the bytes, and its struct format character."""

    offset: int
    code: str


@lru_cache(_DECLARATIONS)
def field_type(declared: str) -> FieldType:
    """Return the `FieldType` of a declaration such as ``sequence<double, 3>``."""
    if match := _SEQUENCE.fullmatch(declared):
        return FieldType(match[1], True, None)
    if match := _ARRAY.fullmatch(declared):
        return FieldType(match[1], False, int(match[2]))
    return FieldType(declared, False, None)


@lru_cache(_DECLARATIONS)
def is_string(item: str) -> bool:
    """Return whether an element type is a (bounded) 8-bit string."""
    return _STRING.fullmatch(item) is not None


def encode(message: Message) -> bytes:
    """
    Return the canonical bytes of a message, encapsulation header included.

    Raises
    ------
    CdrError
        a fixed array of the wrong length, or a field type without canonical form.

    """
    encoder = _Encoder()
    encoder.add_message(message, '')
    return bytes(encoder.buffer)


def encode_with_slots(message: Message) -> tuple[bytes, dict[str, Slot]]:
    """
    Return the canonical bytes and the slot of each primitive in them.

    Slots are named by their path: ``header.stamp.sec``, ``position[0]``.

    Raises
    ------
    CdrError
        as `encode`.

    """
    encoder = _Encoder()
    encoder.add_message(message, '')
    return bytes(encoder.buffer), encoder.slots()


def put_length(buffer: bytearray, n: int) -> None:
    """Append the length of a string or sequence to the bytes of a message so far."""
    buffer += bytes(-len(buffer) % _LENGTH.size) + _LENGTH.pack(n)


def put_string(buffer: bytearray, value: str) -> None:
    """Append a string to the bytes of a message so far."""
    text = value.encode() + b'\0'
    put_length(buffer, len(text))
    buffer += text


class _Encoder:
    """Encoder of one message: its bytes so far, and the sequences of primitives in them."""

    def __init__(self) -> None:
        self.buffer = bytearray(ENCAPSULATION)
        self._runs: list[tuple[str, int, str, int | None]] = []

    def slots(self) -> dict[str, Slot]:
        """Return the slot of every primitive, one per element of an array."""
        slots = {}
        for path, offset, code, count in self._runs:
            if count is None:
                slots[path] = Slot(offset, code)
                continue
            size = struct.calcsize(f'<{code}')
            for k in range(count):
                slots[f'{path}[{k}]'] = Slot(offset + k * size, code)
        return slots

    def add_message(self, message: Message, prefix: str) -> None:
        """Append every field in wire order; one zero byte for a message without fields."""
        declared = message.get_fields_and_field_types()
        if not declared:
            self.buffer.append(0)
        for name, text in declared.items():
            self._add_field(field_type(text), getattr(message, name), f'{prefix}{name}')

    def _add_field(self, declared: FieldType, value: Any, path: str) -> None:
        if declared.is_sequence:
            self._add_primitives('I', [len(value)], path, is_listed=False)
        elif declared.length is None:
            self._add_items(declared.item, [value], path, is_array=False)
            return
        elif len(value) != declared.length:
            raise CdrError(f'{path} has {len(value)} elements, must have {declared.length}')
        self._add_items(declared.item, value, path, is_array=True)

    def _add_items(self, item: str, values: Sequence[Any], path: str, is_array: bool) -> None:
        if item in PRIMITIVES:
            if item == 'octet':
                values = [value[0] for value in values]
            self._add_primitives(PRIMITIVES[item], values, path, True, is_array)
            return
        if not is_string(item) and '/' not in item:
            raise CdrError(f'{path} is a {item}, which has no canonical encoding here')
        for k, value in enumerate(values):
            if is_string(item):
                put_string(self.buffer, value)
            else:
                self.add_message(value, f'{path}[{k}].' if is_array else f'{path}.')

    def _add_primitives(
            self, code: str, values: Iterable[Any], path: str,
            is_listed: bool, is_array: bool = False) -> None:
        native = np.asarray(values, dtype=f'<{code}')
        if native.size == 0:
            return
        self.buffer += bytes(-(len(self.buffer) - len(ENCAPSULATION)) % native.itemsize)
        if is_listed:
            count = native.size if is_array else None
            self._runs.append((path, len(self.buffer), code, count))
        self.buffer += native.tobytes()
