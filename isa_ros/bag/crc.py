"""
CRC-32 of two consecutive blocks of bytes from the CRC of each, so that no byte is read twice.

A CRC is a remainder modulo a polynomial over GF(2): appending n bytes multiplies it by x^(8 n)
and adds the CRC of the appended bytes. Polynomials are 32 bits with the coefficient of x^0 in
the highest one, as in zlib.
"""

_POLYNOMIAL = 0xEDB88320  # of zlib.crc32, IEEE 802.3
_ONE = 1 << 31
_X = 1 << 30
_BITS_PER_BYTE_LOG2 = 3


def product(a: int, b: int) -> int:
    """Return a b modulo the polynomial."""
    result = 0
    while a:
        if a & _ONE:
            result ^= b
        a = a << 1 & 0xFFFFFFFF
        b = b >> 1 ^ _POLYNOMIAL if b & 1 else b >> 1
    return result


def _squares(n: int) -> list[int]:
    """Return x^(2^k) for k < n."""
    powers = [_X]
    for _ in range(n - 1):
        powers.append(product(powers[-1], powers[-1]))
    return powers


_POWERS = _squares(64)


def combined(first: int, second: int, n_second: int) -> int:
    """Return the CRC of bytes with CRC ``first``, followed by ``n_second`` with CRC ``second``."""
    shift, k = _ONE, _BITS_PER_BYTE_LOG2
    while n_second:
        if n_second & 1:
            shift = product(_POWERS[k], shift)
        n_second >>= 1
        k += 1
    return product(shift, first) ^ second
