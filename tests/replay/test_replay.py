"""Replay: its inputs, the result of a changed input, and of a bag cut short."""

from pathlib import Path
import shutil

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.cli.main import main
from isa_ros.config.run_config import RunConfig
from isa_ros.replay.replay import recorded_inputs, replay, Rerun
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
    run = RunConfig.from_yaml(bag.provenance.configuration)
    commands, tuned, n_ticks = recorded_inputs(bag, run)
    assert (tuned, n_ticks) == ({}, 80)
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
