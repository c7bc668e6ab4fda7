"""The index of a chunk: of each channel, time and place of every message, in their order."""

from itertools import groupby

from hypothesis import given, strategies as st
from isa_ros.bag.message_chunk import Buffers, Chunk, Layouts, MESSAGE_HEADER
import numpy as np
import pytest

PREFIX = b'schemas and channels'
TICKS = st.lists(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 9)), max_size=6).map(sorted))
"""(topic, size) of the messages of each tick; several of a topic, or none at all."""


def filled(ticks: list[list[tuple[int, int]]], buffers: Buffers) -> Chunk:
    """Return a chunk with messages of these topics and sizes; tick k is at 7 k + 3 ns."""
    chunk = Chunk(PREFIX, Layouts(), buffers.take())
    for k, messages in enumerate(ticks):
        chunk.add(7 * k + 3, k, [(topic, bytes(size)) for topic, size in messages])
    return chunk


@given(ticks=TICKS)
def test_every_message_is_found_by_its_channel(ticks: list[list[tuple[int, int]]]) -> None:
    """Channels count from 1; the records are read one after another."""
    chunk = filled(ticks, Buffers())
    data, at, expected = bytes(chunk.data()), len(PREFIX), []
    while at < len(data):
        _, length, channel, _, t_ns, _ = MESSAGE_HEADER.unpack_from(data, at)
        expected.append((channel, t_ns, at))
        at += 9 + length
    assert len(expected) == sum(map(len, ticks))
    assert [(channel, entries.tolist()) for channel, entries in chunk.message_indices()] == [
        (channel, [[t_ns, at] for _, t_ns, at in messages])
        for channel, messages in groupby(sorted(expected), key=lambda message: message[0])]


def test_memory_is_filled_again() -> None:
    """That of two chunks: a third one is written only while two others are in use."""
    buffers = Buffers()
    chunks = [filled([[(0, 5)]], buffers) for _ in range(3)]
    for chunk in chunks:
        buffers.give(chunk.buffer)
    again = [buffers.take() for _ in range(3)]
    assert [sum(own is chunk.buffer for chunk in chunks) for own in again] == [1, 1, 0]


@pytest.mark.parametrize('n', [3, 3_000_000])
def test_a_chunk_gives_the_memory_that_it_has_used(n: int) -> None:
    """Also where a tick is larger than what it was given."""
    given_first = Buffers().take()
    chunk = Chunk(PREFIX, Layouts(), given_first)
    chunk.add(0, 0, [(0, bytes(n))])
    assert (chunk.buffer is given_first) == (n == 3)
    assert len(chunk.buffer) >= chunk.size == len(PREFIX) + MESSAGE_HEADER.size + n
    assert bytes(chunk.data()[:len(PREFIX)]) == PREFIX
    assert not np.any(chunk.buffer[chunk.size - n:chunk.size])
