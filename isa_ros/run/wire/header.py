"""What every message of the wire begins with."""

import struct

from isa_ros.errors import RunError

VERSION = 10

_ENCAPSULATION = 0x00000100  # bytes 00 01 00 00: little endian CDR, no options
_PREFIX_BYTES = 16


class WireError(RunError):
    """Bytes that are not a message of the wire, or do not fit its run."""


def prefix(size: int) -> tuple[int, int, int, int]:
    """Return what precedes a message of ``size`` bytes: no dimensions, offset 0, array length."""
    return _ENCAPSULATION, 0, 0, size - _PREFIX_BYTES


def opened(data: bytes, header: struct.Struct, what: str) -> tuple[tuple[int, ...], bytes]:
    """
    Return the fields of a header after the version, and the body.

    Raises
    ------
    WireError
        The bytes are not a message, or from another version of this package.

    """
    if len(data) < header.size:
        raise WireError(f'{len(data)} bytes, a {what} has at least {header.size}')
    _, _, _, size, version, *fields = header.unpack_from(data)
    if version != VERSION:
        raise WireError(
            f'lockstep wire version = {version}, must be {VERSION}: coordinator and '
            'participants must be of the same version of isa_ros')
    end = _PREFIX_BYTES + size
    if not header.size <= end <= len(data):
        raise WireError(f'a {what} of {end} bytes in {len(data)}')
    return tuple(fields), data[header.size:end]
