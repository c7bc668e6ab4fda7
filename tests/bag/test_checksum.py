"""The checksum of joined bytes against zlib's of all of them."""

import zlib

from hypothesis import example, given, strategies as st
from isa_ros.bag.checksum import joined
import pytest

LONGEST = bytes(range(256)) * 4196     # a chunk and the tick that ends it


@given(first=st.binary(max_size=300), second=st.binary(max_size=300))
@example(first=b'', second=b'')
@example(first=b'abc', second=b'')
@example(first=b'', second=b'abc')
def test_it_is_that_of_all_bytes(first: bytes, second: bytes) -> None:
    assert joined(zlib.crc32(first), zlib.crc32(second), len(second)) == zlib.crc32(first + second)


@pytest.mark.parametrize('n', [1, 2, 255, 65_536, 1_048_575, 1_048_576, 1_048_577, len(LONGEST)])
def test_it_is_so_for_chunks(n: int) -> None:
    """Of each length twice: the second time it is a known one."""
    second = LONGEST[:n]
    for first in (b'head', LONGEST):
        assert joined(zlib.crc32(first), zlib.crc32(second), n) == zlib.crc32(second, zlib.crc32(
            first))


def test_pieces_may_be_joined_one_by_one() -> None:
    pieces = [LONGEST[k:2 * k] for k in (1, 10, 100, 1000, 10_000)]
    total = 0
    for piece in pieces:
        total = joined(total, zlib.crc32(piece), len(piece))
    assert total == zlib.crc32(b''.join(pieces))
