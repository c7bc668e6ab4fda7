"""A recorder in memory."""

from collections.abc import Sequence


class FakeRecorder:
    """Keeps every sample, and writes a line into a log that it shares with others."""

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self.samples: list[tuple[int, int, list[tuple[int, bytes]]]] = []

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        self.log.append(f'record {sequence}')
        self.samples.append((t_ns, sequence, list(messages)))
