"""Cyclone DDS from Python, reliable, on this host only."""

import os
from pathlib import Path
from typing import Any, NamedTuple

from cyclonedds.core import (
    InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet)
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from isa_ros.core.signals import COMMAND, LOAD_PORT

ANSWER_BYTES = 1024
HEAD_BYTES = 64  # upper bound for the head of a step
_WORKERS = 'workers'  # file with the number of workers, in the directory of a run
_DEPTH = 64  # as for the topics of the lockstep
_LOOPBACK = """
<CycloneDDS><Domain Id="any">
  <General>
    <Interfaces><NetworkInterface name="lo"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
    <FragmentSize>4000B</FragmentSize>
  </General>
  <Discovery>
    <ParticipantIndex>auto</ParticipantIndex>
    <MaxAutoParticipantIndex>100</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers>
  </Discovery>
</Domain></CycloneDDS>
"""
_ANY = SampleState.Any | ViewState.Any | InstanceState.Alive


class Octets(NamedTuple):
    """
    A topic of raw messages of up to ``size`` bytes.

    The type has a field of fixed size: Python's encoder is slow with sequences.
    """

    topic: str
    size: int

    @property
    def message_type(self) -> Any:
        """Return the type of its messages."""
        name = f'Octets{self.size}'
        return make_idl_struct(name, name, {
            'length': types.uint32, 'octets': types.array[types.uint8, self.size]})


class TopicEnd:
    """A writer of one topic and a reader of the other."""

    def __init__(self, written: Octets, read: Octets) -> None:
        number = int(os.environ.get('ROS_DOMAIN_ID') or 0)
        self._domain = Domain(number, _LOOPBACK)
        participant = DomainParticipant(number)
        qos = Qos(
            Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(_DEPTH))
        self._message, self._size = written.message_type, written.size
        self._received = read.message_type
        self._writer = DataWriter(
            participant, Topic(participant, written.topic, self._message), qos=qos)
        self._reader = DataReader(
            participant, Topic(participant, read.topic, self._received), qos=qos)
        self._condition = ReadCondition(self._reader, _ANY)
        self._wait_set = WaitSet(participant)
        self._wait_set.attach(self._condition)

    def send(self, message: bytes) -> None:
        """Write to all matched readers."""
        self._writer.write(self._message(
            length=len(message), octets=message.ljust(self._size, b'\0')))

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next message; wait for it if there is none."""
        samples = self._reader.take(condition=self._condition)
        if not samples and self._wait_set.wait(int(timeout_s * 1e9)):
            samples = self._reader.take(condition=self._condition)
        for sample in samples:
            if isinstance(sample, self._received):
                return bytes(sample.octets[:sample.length])
        return None

    def close(self) -> None:
        """Do nothing: at its end the process closes the entities in the right order."""


def coordinator_end(directory: Path, n_workers: int) -> TopicEnd:
    """Write steps and read answers."""
    (directory / _WORKERS).write_text(str(n_workers))
    return TopicEnd(*_topics(directory))


def worker_end(directory: Path, index: int) -> TopicEnd:
    """Read steps and write answers."""
    steps, answers = _topics(directory)
    return TopicEnd(answers, steps)


def _topics(directory: Path) -> tuple[Octets, Octets]:
    """Return the topics of steps and of answers; only this run uses them."""
    n_workers = int((directory / _WORKERS).read_text())
    step = HEAD_BYTES + n_workers * (LOAD_PORT.itemsize + COMMAND.itemsize)
    return (Octets(f'{directory.name}_steps', step),
            Octets(f'{directory.name}_answers', ANSWER_BYTES))
