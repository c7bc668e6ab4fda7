"""What records the messages of a run."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from isa_ros.bag.message_chunk import Room
from isa_ros.bag.packed import Layout


class Recorder(Protocol):
    """Receives every sample of a run, in order of time."""

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """
        Append one sample: (index into the sorted topics, CDR) with ascending index.

        Raises
        ------
        RunError
            The sample cannot be written, for example because the disk is full.

        """
        ...


@runtime_checkable
class QuietRecorder(Recorder, Protocol):
    """A recorder that gives room for the records of ticks of one layout."""

    def open_stretch(self, layout: Layout, t_ns: int, step_ns: int) -> Room:
        """Return room for ticks from ``t_ns`` on; as `isa_ros.bag.writer.BagWriter`."""
        ...

    def close_stretch(self, n_ticks: int) -> None:
        """Record the first ticks that were written since `open_stretch`, possibly none."""
        ...
