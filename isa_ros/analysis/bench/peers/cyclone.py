"""Cyclone DDS from Python, reliable, on this host alone."""

from dataclasses import dataclass
import os
from pathlib import Path

from cyclonedds.core import (
    InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet)
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

LARGEST = 1024  # bytes of a message: three times load port and command, or one answer
_DEPTH = 10     # as the lockstep's own topics
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


@dataclass
class Octets(IdlStruct):
    """A message as it is, in a field of fixed size: Python's encoder is slow with sequences."""

    length: types.uint32
    octets: types.array[types.uint8, LARGEST]


class End:
    """A writer of one topic and a reader of the other."""

    def __init__(self, written: str, read: str) -> None:
        number = int(os.environ.get('ROS_DOMAIN_ID') or 0)
        self._domain = Domain(number, _LOOPBACK)
        participant = DomainParticipant(number)
        qos = Qos(
            Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(_DEPTH))
        self._writer = DataWriter(participant, Topic(participant, written, Octets), qos=qos)
        self._reader = DataReader(participant, Topic(participant, read, Octets), qos=qos)
        self._condition = ReadCondition(self._reader, _ANY)
        self._wait_set = WaitSet(participant)
        self._wait_set.attach(self._condition)

    def send(self, message: bytes) -> None:
        """Write to whoever is matched."""
        self._writer.write(Octets(len(message), message.ljust(LARGEST, b'\0')))

    def receive(self, timeout_s: float) -> bytes | None:
        """Take what is there, or wait for it."""
        samples = self._reader.take(condition=self._condition)
        if not samples and self._wait_set.wait(int(timeout_s * 1e9)):
            samples = self._reader.take(condition=self._condition)
        for sample in samples:
            if isinstance(sample, Octets):
                return bytes(sample.octets[:sample.length])
        return None

    def close(self) -> None:
        """Leave the domain to the end of the process, which knows the order."""


def coordinator_end(directory: Path, n_workers: int) -> End:
    """Write steps and read answers."""
    return End(*_topics(directory))


def worker_end(directory: Path, index: int) -> End:
    """Read steps and write answers."""
    steps, answers = _topics(directory)
    return End(answers, steps)


def _topics(directory: Path) -> tuple[str, str]:
    """Return the topics of steps and of answers, of this run alone."""
    return f'{directory.name}_steps', f'{directory.name}_answers'
