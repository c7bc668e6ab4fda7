"""Replay: its inputs, the result of a changed input, and of a bag cut short."""

from pathlib import Path
import shutil

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.cli.main import main
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.errors import BagError
from isa_ros.replay.replay import recorded_inputs, replay, Rerun
from msg_adapters import event
from msg_adapters.setpoint import applied_to_command
import pytest
from tests.bag.golden import GOLDEN as GOLDEN_BAGS, rewrite
from tests.messages import applied_setpoint

GOLDEN = GOLDEN_BAGS / 'leg_touchdown'
CHANGED = '/kfe/applied_setpoint'
EFFORT_TICK = 50  # the scenario's effort of 200 N takes effect there


@pytest.fixture
def here(tmp_path) -> Path:
    """Return a bag that this machine recorded with these versions: the golden run anew."""
    directory = tmp_path / 'here'
    golden = Bag(GOLDEN)
    again = Rerun(golden)
    with BagWriter(directory, again.topics, golden.provenance) as writer:
        again.simulate(writer)
    return directory


def one_percent_more(topic: str, sequence: int, data: bytes) -> bytes:
    """Change the effort of one applied setpoint by 1 %."""
    if topic != CHANGED or sequence != EFFORT_TICK + 1:
        return data
    command = applied_to_command(data, 'kfe')
    command['effort'] *= 1.01
    return applied_setpoint('kfe', command, EFFORT_TICK * 1_000_000)


def test_recorded_commands_take_effect_at_their_ticks():
    """The applied setpoints of sample k + 1 are the commands of tick k."""
    bag = Bag(GOLDEN)
    run = run_of_text(bag.provenance.configuration)
    commands, tuned, supplies, ports, n_ticks, has_end = recorded_inputs(bag, run)
    assert (tuned, supplies, ports, n_ticks, has_end) == ({}, {}, {}, 80, True)
    assert sorted(commands) == [0, EFFORT_TICK]
    assert [row for row, _ in commands[0]] == [0, 1, 2]
    (row, command), = commands[EFFORT_TICK]
    assert (row, command['effort']) == (run.index('kfe'), 200.0)


def test_a_setpoint_changed_by_one_percent_is_found(here, tmp_path, capsys):
    """Exit code 1, with the first differing tick, topic and field."""
    changed = tmp_path / 'changed'
    rewrite(Bag(here), changed, one_percent_more)
    difference = replay(Bag(changed)).report.difference
    assert difference is not None
    # the knee's loop responds within the tick, and so does the foot; topics are sorted
    assert difference.tick == EFFORT_TICK + 1
    assert (difference.topic, difference.field) == (
        '/coordinator/ground_contact', 'wrench.force.x')
    assert main(['replay', str(changed)]) == 1
    out = capsys.readouterr().out
    assert 'differ: tick 51 (t = 0.051000 s), /coordinator/ground_contact, wrench.force.x' in out


def test_a_damaged_bag_is_an_error(here, tmp_path, capsys):
    """Exit code 2, one line with the file."""
    damaged = tmp_path / 'damaged'
    shutil.copytree(here, damaged)
    path = next(damaged.glob('*.mcap'))
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)
    assert main(['replay', str(damaged)]) == 2
    error = capsys.readouterr().err
    assert error.count('\n') == 1
    assert str(path) in error


def test_a_bag_cut_short_replays_to_its_end(here, tmp_path, capsys):
    """Exit code 0; the report has the time of the end."""
    cut = tmp_path / 'cut'
    cut.mkdir()
    path = next(here.glob('*.mcap'))
    (cut / 'cut_0.mcap').write_bytes(path.read_bytes()[:-9000])
    assert main(['replay', str(cut)]) == 0
    out = capsys.readouterr().out
    assert 'the bag was cut short there' in out
    assert 'up to t = 0.080000 s' in out


@pytest.mark.parametrize('topic, tick', [
    (CHANGED, 1), ('/hfe/valve', 7), ('/coordinator/ground_contact', 0), ('/clock', 80)])
def test_a_cut_message_is_located(here, tmp_path, capsys, topic, tick):
    """Exit code 2; one line with the bag, the message, its topic and its tick."""
    bag = rewrite(Bag(here), tmp_path / 'changed', lambda name, sequence, data: (
        data[:8] if (name, sequence) == (topic, tick) else data))
    assert main(['replay', str(bag)]) == 2
    error = capsys.readouterr().err
    assert error.count('\n') == 1
    messages = list(Bag(here).messages())
    number = [(m.topic, m.sequence) for m in messages].index((topic, tick)) + 1
    assert error.startswith(
        f'isa: {Bag(bag).path}: message {number} of {len(messages)}, {topic}, tick {tick} '
        f'(t = {tick / 1000:.6f} s): ')


def test_a_cut_event_is_located(here, tmp_path):
    """The events of a run are inputs of its replay."""
    golden = Bag(here)
    topics = [*Rerun(golden).topics]
    index = [topic.name for topic in topics].index('/coordinator/events')
    with BagWriter(tmp_path / 'bag', topics, golden.provenance) as writer:
        writer.write_tick(0, 0, [(index, event.pack(0, 'pause')[:20])])
    with pytest.raises(BagError, match=(
            r'bag_0.mcap: message 1 of 1, /coordinator/events, tick 0 \(t = 0.000000 s\): Log: ')):
        replay(Bag(tmp_path / 'bag'))


def test_padding_and_sequence_numbers_are_replayed_too(here, tmp_path):
    """What is equal in every field is not yet equal in every byte."""
    def padded(topic: str, sequence: int, data: bytes) -> bytes:
        at = data.find(b'kfe/spool\0') + 10     # padded to 12 bytes
        is_changed = (topic, sequence) == ('/kfe/valve', 7)
        return data[:at] + b'\xff' + data[at + 1:] if is_changed else data

    found = replay(Bag(rewrite(Bag(here), tmp_path / 'padded', padded))).report.difference
    assert found is not None
    assert (found.tick, found.topic, found.expected, found.actual) == (7, '/kfe/valve', 0xff, 0)

    golden, again = Bag(here), Rerun(Bag(here))
    index = {topic.name: k for k, topic in enumerate(again.topics)}
    with BagWriter(tmp_path / 'counted', again.topics, golden.provenance) as writer:
        for tick in golden.ticks():
            writer.write_tick(tick.t_ns, tick.sequence + (tick.sequence == 7), [
                (index[m.topic], m.data) for m in tick.messages])
    found = replay(Bag(tmp_path / 'counted')).report.difference
    assert found is not None
    assert (found.field, found.expected, found.actual) == ('sequence', 8, 7)
