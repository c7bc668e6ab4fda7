"""Decode messages from their CDR bytes; every length is checked before it is used."""

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
import re
import struct
from typing import Any, TypeVar

from msg_adapters.cdr import CdrError, ENCAPSULATION, field_type, FieldType, is_string, Message
from msg_adapters.cdr import PRIMITIVES

M = TypeVar('M', bound=Message)
_TYPE = re.compile(r'(?P<package>[a-z][a-z0-9_]*)/(?:msg/)?(?P<name>[A-Z][A-Za-z0-9]*)', re.ASCII)


@cache
def message_class(type_name: str) -> type[Message]:
    """
    Return the message class of ``sensor_msgs/msg/JointState`` or ``sensor_msgs/JointState``.

    Raises
    ------
    CdrError
        no such message package or type is installed.

    """
    parts = _TYPE.fullmatch(type_name)
    if parts is None or not _has_messages(parts['package']):
        raise CdrError(f'{type_name}: no such message type is installed')
    try:
        found: type[Message] = getattr(import_module(f'{parts["package"]}.msg'), parts['name'])
    except (ImportError, AttributeError) as error:
        raise CdrError(f'{type_name}: no such message type is installed ({error})') from None
    if not hasattr(found, 'get_fields_and_field_types'):
        raise CdrError(f'{type_name}: is not a message type')
    return found


def _has_messages(package: str) -> bool:
    """Return whether a package has messages; others named in a file must not be imported."""
    found = find_spec(package)
    return found is not None and any(
        (Path(folder) / 'msg' / '__init__.py').is_file()
        for folder in found.submodule_search_locations or ())


def decode(data: bytes, cls: type[M]) -> M:
    """
    Return the message from its CDR bytes; bytes after its last field are ignored.

    Raises
    ------
    CdrError
        the bytes are not a message of this class.

    """
    if data[:2] != ENCAPSULATION[:2]:
        raise CdrError(
            f'{cls.__name__}: encapsulation {data[:2].hex()!r}, '
            f'must be {ENCAPSULATION[:2].hex()!r} (CDR, little endian)')
    return _Decoder(data, cls.__name__).message(cls)


def flatten(message: Message, prefix: str = '') -> Iterator[tuple[str, Any]]:
    """Yield (path, value) of every string and primitive, in wire order."""
    for name, text in message.get_fields_and_field_types().items():
        declared = field_type(text)
        value = getattr(message, name)
        is_array = declared.is_sequence or declared.length is not None
        if declared.is_sequence:
            yield f'{prefix}{name}.length', len(value)
        for k, item in enumerate(value if is_array else [value]):
            path = f'{prefix}{name}[{k}]' if is_array else f'{prefix}{name}'
            if '/' in declared.item:
                yield from flatten(item, f'{path}.')
            else:
                yield path, item.item() if hasattr(item, 'item') else item


class _Decoder:
    """Decoder of one message, with its position in the bytes."""

    def __init__(self, data: bytes, name: str) -> None:
        self._data = data
        self._name = name
        self._position = len(ENCAPSULATION)

    def message(self, cls: type[M]) -> M:
        """Read every field of one message."""
        result = cls()
        declared = cls.get_fields_and_field_types()
        if not declared:
            self._take(1)
        for name, text in declared.items():
            value = self._field(field_type(text))
            try:
                setattr(result, name, value)
            except AssertionError:  # raised by message classes beyond a bound of the type
                raise CdrError(f'{self._name}: {name} is beyond {text}') from None
        return result

    def _field(self, declared: FieldType) -> Any:
        if declared.is_sequence:
            return self._items(declared.item, self._primitives('I', 1)[0])
        if declared.length is not None:
            return self._items(declared.item, declared.length)
        return self._items(declared.item, 1)[0]

    def _items(self, item: str, count: int) -> list[Any]:
        if item == 'octet':
            return [bytes([value]) for value in self._primitives('B', count)]
        if item in PRIMITIVES:
            return list(self._primitives(PRIMITIVES[item], count))
        if count > len(self._data) - self._position:  # an element has at least one byte
            self._fail(f'{count} elements of {item}')
        if is_string(item):
            return [self._string() for _ in range(count)]
        cls = message_class(item)
        return [self.message(cls) for _ in range(count)]

    def _string(self) -> str:
        text = self._take(self._primitives('I', 1)[0])
        try:
            return text[:-1].decode() if text.endswith(b'\0') else text.decode()
        except UnicodeDecodeError as error:
            raise CdrError(f'{self._name}: a string is not UTF-8 ({error.reason})') from None

    def _primitives(self, code: str, count: int) -> tuple[Any, ...]:
        if count == 0:
            return ()
        size = struct.calcsize(f'<{code}')
        self._position += -(self._position - len(ENCAPSULATION)) % size
        return struct.unpack(f'<{count}{code}', self._take(size * count))

    def _take(self, size: int) -> bytes:
        start = self._position
        self._position += size
        if self._position > len(self._data):
            self._fail(f'{size} bytes at offset {start}')
        return self._data[start:self._position]

    def _fail(self, wanted: str) -> None:
        raise CdrError(
            f'{self._name}: {wanted} do not fit, the message has {len(self._data)} bytes')
