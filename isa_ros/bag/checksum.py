"""
The CRC-32 of joined bytes from those of their parts, so that each byte is summed once.

A CRC-32 is the remainder of its bytes as a polynomial over GF(2), by the generator of zlib. Bytes
behind them multiply it by x^8 each: crc(A B) = crc(A) x^(8 |B|) + crc(B). Bit 31 of a polynomial
is the coefficient of x^0, and addition is exclusive or.
"""

from functools import cache, lru_cache

_GENERATOR = 0xEDB88320
_ONE = 1 << 31
_X8 = 1 << 23
_LENGTHS = 64   # that are remembered: most chunks of a run have one of few


def joined(first: int, second: int, second_bytes: int) -> int:
    """Return the checksum of two pieces of data from theirs and the length of the second."""
    return _product(_bytes_behind(second_bytes), first) ^ second


@lru_cache(_LENGTHS)
def _bytes_behind(n: int) -> int:
    """Return x^(8 n)."""
    power = _ONE
    for bit in range(n.bit_length()):
        if n >> bit & 1:
            power = _product(power, _squared(bit))
    return power


@cache
def _squared(times: int) -> int:
    """Return x^8, squared so many times."""
    root = _squared(times - 1) if times else 0
    return _product(root, root) if times else _X8


def _product(a: int, b: int) -> int:
    """Return a b modulo the generator."""
    product = 0
    while a:
        if a & _ONE:
            product ^= b
        a = a << 1 & 0xFFFFFFFF
        b = b >> 1 ^ _GENERATOR if b & 1 else b >> 1
    return product
