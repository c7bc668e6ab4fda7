"""The messages of one tick in one block of memory, with the bytes of the file."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, overload

import numpy as np


class Layout(NamedTuple):
    """
    Topic and position of each message in a block: (n,) each, by ascending topic.

    Blocks of one layout differ only in their numbers.
    """

    topics: np.ndarray
    """Index into the sorted topics, int64."""
    starts: np.ndarray
    """Offset of the CDR bytes in the block, int64."""
    sizes: np.ndarray
    """Number of CDR bytes, int64."""


def layout(topics: Sequence[int], starts: Sequence[int], sizes: Sequence[int]) -> Layout:
    """Return a layout from plain numbers."""
    return Layout(*(np.array(column, np.int64) for column in (topics, starts, sizes)))


class Packed(Sequence[tuple[int, bytes]]):
    """Messages of a tick as a sequence of (topic index, CDR bytes), without an object for each."""

    def __init__(self, block: np.ndarray, where: Layout) -> None:
        self.block = block
        """Bytes, ``u1``; valid until the next tick is packed."""
        self.layout = where

    @classmethod
    def of(cls, messages: Sequence[tuple[int, bytes]]) -> 'Packed':
        """Return the same messages in a block."""
        if type(messages) is cls:   # `isinstance` of an abstract class takes ten times as long
            return messages
        sizes = [len(data) for _, data in messages]
        starts = np.cumsum([0, *sizes])[:-1]
        block = np.frombuffer(b''.join(data for _, data in messages), np.uint8)
        return cls(block, layout([k for k, _ in messages], list(starts), sizes))

    def __len__(self) -> int:
        return len(self.layout.topics)

    @overload
    def __getitem__(self, place: int) -> tuple[int, bytes]: ...

    @overload
    def __getitem__(self, place: slice) -> list[tuple[int, bytes]]: ...

    def __getitem__(
            self, place: int | slice) -> tuple[int, bytes] | list[tuple[int, bytes]]:
        if isinstance(place, slice):
            return [self[k] for k in range(*place.indices(len(self)))]
        start = self.layout.starts[place]
        return int(self.layout.topics[place]), bytes(
            self.block[start:start + self.layout.sizes[place]])

    def __iter__(self) -> Iterator[tuple[int, bytes]]:
        data, own = self.block.data, self.layout
        for topic, start, size in zip(
                own.topics.tolist(), own.starts.tolist(), own.sizes.tolist()):
            yield topic, bytes(data[start:start + size])

    def selected(self, places: Sequence[int], topics: Sequence[int]) -> 'Packed':
        """Return the messages at some positions, with other topic indices."""
        chosen = np.array(places, np.int64)
        return Packed(self.block, Layout(
            np.array(topics, np.int64), self.layout.starts[chosen], self.layout.sizes[chosen]))
