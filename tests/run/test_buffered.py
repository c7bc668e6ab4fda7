"""Recorders get the messages of quiet ticks one by one, and replays the bytes of single ticks."""

from pathlib import Path

from isa_ros.bag.message_chunk import append
from isa_ros.bag.packed import layout, Packed
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.replay.replay import replay
from isa_ros.run import buffered as module
from isa_ros.run.buffered import Buffered, quiet
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.run.thinning import Thinning
from isa_ros.scripting.run import load, Run
from isa_ros.tick.quiet import QuietTicks
from isa_ros.tick.tick_loop import TickLoop
import numpy as np
import pytest
from tests.tick.quietly import advance

CALLS = (1, 3, 20, 100, 10**6)
BLOCK = np.arange(40, dtype=np.uint8)
LAYOUT = layout([2, 5, 6], [7, 0, 30], [3, 5, 1])


class Told:
    """Keeps the messages of each tick."""

    def __init__(self) -> None:
        self.ticks: list[object] = []

    def write_tick(self, t_ns, sequence, messages) -> None:
        self.ticks.append((t_ns, sequence, list(messages)))


def test_a_recorder_gets_each_tick_of_a_stretch():
    """With its time, number and messages, as far as they were filled."""
    told = Told()
    recorder = Buffered(told)
    for first in (40, 90):
        room = recorder.open_stretch(LAYOUT, 1_000 * first, 500)
        for k in range(3):
            append(room.buffer, room.at + k * room.tick_bytes, BLOCK + np.uint8(k), LAYOUT,
                   first + k, 1_000 * first + 500 * k)
        recorder.close_stretch(2)
        expected = [(1_000 * first + 500 * k, first + k, list(Packed(BLOCK + np.uint8(k), LAYOUT)))
                    for k in range(2)]
        assert told.ticks[-2:] == expected and len(expected[0][2]) == 3
    assert len(told.ticks) == 4
    recorder.write_tick(1, 2, [(3, b'4')])
    assert told.ticks[-1] == (1, 2, [(3, b'4')])


@pytest.mark.parametrize(('size', 'ticks'), [(50, 1), (306, 3), (303, 2)])
def test_there_is_room_for_the_ticks_that_fit(monkeypatch, size, ticks):
    """102 bytes each; one in any case."""
    monkeypatch.setattr(module, 'BUFFER_BYTES', size)
    room = Buffered(Told()).open_stretch(LAYOUT, 0, 1)
    assert (room.tick_bytes, room.n_ticks) == (102, ticks)
    assert len(room.buffer) >= ticks * 102


def test_nothing_is_passed_on_before_a_stretch():
    told = Told()
    Buffered(told).close_stretch(0)
    assert not told.ticks


def test_a_recorder_that_takes_stretches_is_taken_as_it_is():
    recorder = Buffered(Told())
    assert quiet(recorder) is recorder
    assert isinstance(quiet(Told()), Buffered)


@pytest.fixture
def quietly(monkeypatch) -> list[int]:
    """Return how many ticks each call of quiet ticks has made."""
    made: list[int] = []
    run = QuietTicks.run

    def note(self, *given):
        done, ended = run(self, *given)
        made.append(done)
        return done, ended
    monkeypatch.setattr(QuietTicks, 'run', note)
    return made


def thinned(directory: Path, run: Run, n_ticks: int, call: int) -> bytes:
    """Return the messages of a run's bag, in the order of its file."""
    simulation, config = run.simulation(), run.configuration
    packer = packer_of(config, simulation.loop.rows.published)
    thinning = Thinning(config.record, packer.topics)
    with BagWriter(directory, thinning.topics, provenance_of(simulation.scenario)) as bag:
        simulation.loop.sinks = (
            RunOutput(packer, config.step_ns, thinning.recorder(bag)),)
        advance(simulation, n_ticks, (call,))
    file, = directory.glob('*.mcap')
    return file.read_bytes()


@pytest.mark.parametrize('record', [
    {'leave_out': ['*/pressure_*', '/clock']}, {'decimate': {'*/valve': 7, '*/load_cell': 3}},
    {'decimate': {'*': 50}}, {'leave_out': ['*']}], ids=str)
def test_a_thinned_bag_has_the_same_bytes_however_many_ticks_are_in_a_call(
        tmp_path, quietly, record):
    """Also where most ticks have no message, and chunks end with one of them."""
    run = load('leg', scenario='drop').replace({'record': record})
    found = [thinned(tmp_path / str(call), run, 620, call) for call in CALLS]
    assert len(set(found)) == 1
    assert max(quietly) > 50


@pytest.mark.parametrize('call', CALLS)
def test_a_replay_is_quiet_between_commands(tmp_path, quietly, monkeypatch, call):
    """Its comparison has seen every tick of the bag."""
    run = load('leg', scenario='drop')
    simulation, config = run.simulation(), run.configuration
    packer = packer_of(config, simulation.loop.rows.published)
    with BagWriter(tmp_path / 'bag', packer.topics, provenance_of(simulation.scenario)) as bag:
        simulation.loop.sinks = (RunOutput(packer, config.step_ns, bag),)
        advance(simulation, 130, (1,))
    advance_quietly = TickLoop.advance_quietly
    monkeypatch.setattr(TickLoop, 'advance_quietly', lambda self, until: advance_quietly(
        self, min(until, self.ticks + call - 1)))
    quietly.clear()
    report = replay(Bag(tmp_path / 'bag'))
    assert report.is_equal and report.is_whole
    assert max(quietly, default=0) > min(call - 1, 20) * 0.5 or call == 1
    spoilt = Bag(tmp_path / 'bag')
    messages = [own._replace(data=own.data[:-1] + bytes([own.data[-1] ^ 1]))
                if own.sequence == 77 and own.topic.endswith('/valve') else own
                for own in spoilt.messages()]
    monkeypatch.setattr(Bag, 'messages', lambda self: iter(messages))
    found = replay(Bag(tmp_path / 'bag'))
    assert not found.is_equal and '0.077' in str(found)
