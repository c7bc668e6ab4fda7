"""The symbols of an object file of Linux (ELF, 64 bits, little-endian)."""

from collections.abc import Iterator
import struct
from typing import NamedTuple

_SECTIONS_AT, _SECTION_COUNT_AT = 0x28, 0x3c
_SECTION = struct.Struct('<IIQQQQIIQQ')
_SYMBOL = struct.Struct('<IBBHQQ')
_SYMBOL_TABLE = 2
_LOCAL = 0


class Symbol(NamedTuple):
    """A symbol, and whether other objects see it, and whether it is defined."""

    name: str
    is_local: bool
    is_defined: bool


def symbols(code: bytes) -> Iterator[Symbol]:
    """Yield the named symbols of an object file."""
    at, = struct.unpack_from('<Q', code, _SECTIONS_AT)
    count, = struct.unpack_from('<H', code, _SECTION_COUNT_AT)
    sections = [_SECTION.unpack_from(code, at + k * _SECTION.size) for k in range(count)]
    for _, kind, _, _, offset, size, link, *_ in sections:
        if kind != _SYMBOL_TABLE:
            continue
        names = sections[link][4]
        for name, info, _, section, *_ in _SYMBOL.iter_unpack(code[offset:offset + size]):
            if name:
                end = code.index(b'\0', names + name)
                yield Symbol(code[names + name:end].decode(), info >> 4 == _LOCAL, section != 0)


def undefined_symbols(code: bytes) -> list[str]:
    """Return the names that an object file refers to and does not define, sorted."""
    return sorted(symbol.name for symbol in symbols(code) if not symbol.is_defined)
