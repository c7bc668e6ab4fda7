"""Messages to a worker and back, and workers that do not answer."""

from isa_ros.bench.peers import frames
from isa_ros.bench.peers.catalogue import peer
from isa_ros.bench.peers.transport import PeerTransport
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.run_config import RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.core.signals import COMMAND, LOAD_PORT, LOAD_REPLY, SAMPLE, START
from isa_ros.errors import ConfigError, RunError
from isa_ros.run.exchange import Rows
import numpy as np
import pytest


def rows(dtype: np.dtype, n: int) -> np.ndarray:
    """Return rows whose bytes all differ."""
    return np.frombuffer(bytes(k % 251 for k in range(n * dtype.itemsize)), dtype)


def test_a_tick_crosses_with_the_rows_of_every_worker():
    ports, commands = rows(LOAD_PORT, 3), rows(COMMAND, 3)
    step = frames.decode_step(frames.encode_tick(7, ports, commands))
    assert (step.kind, step.tick) == (frames.Kind.TICK, 7)
    for k in range(3):
        assert step.port(k).tobytes() == ports[k].tobytes()
        assert step.command(k).tobytes() == commands[k].tobytes()


def test_a_start_is_told_from_the_others_by_its_count():
    starts = rows(START, 2)
    step = frames.decode_step(frames.encode_start(4, starts))
    assert (step.kind, step.tick) == (frames.Kind.START, -4)
    assert step.start(1).tobytes() == starts[1].tobytes()


def test_an_answer_crosses_with_its_absent_parts():
    reply, sample = rows(LOAD_REPLY, 1)[0], rows(SAMPLE, 1)[0]
    answer = frames.decode_answer(frames.encode_answer(2, 9, reply, sample, (None, b'abc', b'')))
    assert (answer.worker, answer.tick) == (2, 9)
    assert answer.reply.tobytes() == reply.tobytes()
    assert answer.sample.tobytes() == sample.tobytes()
    assert answer.messages == [None, b'abc', b'']


class Silence:
    """A link without answers."""

    def send(self, message: bytes) -> None:
        """Discard the message."""

    def receive(self, timeout_s: float) -> bytes | None:
        """Return at once."""
        return None

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


@pytest.fixture(scope='module')
def leg() -> RunConfig:
    """Return a run of three actuators."""
    return load_run(find('leg.yaml', CONFIG))


def test_a_worker_that_ended_is_named(leg):
    transport = PeerTransport(Silence(), leg, rows(START, 3), lambda: 'hfe: its worker ended')
    with pytest.raises(RunError, match='hfe: its worker ended'):
        transport.join(Rows(3))


def test_workers_that_never_answer_are_named(leg):
    transport = PeerTransport(Silence(), leg, rows(START, 3), lambda: None)
    with pytest.raises(RunError, match='haa, hfe, kfe: no answer before tick 0'):
        transport.join(Rows(3))
    transport.send(3, Rows(3))
    with pytest.raises(RunError, match='haa, hfe, kfe: no answer to tick 3'):
        transport.receive(Rows(3))


def test_a_wrong_peer_is_answered_with_the_right_one():
    with pytest.raises(ConfigError, match='did you mean zeromq?'):
        peer('zeromk')
