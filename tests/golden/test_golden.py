"""The golden bags replay: the leg's touch-down, a torque step, a push of the knee."""

from pathlib import Path
import subprocess
import sys

from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_reading import run_of_text
import pytest

pytest_plugins = ['isa_ros.testing']
HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BAGS = sorted(path.parent for path in HERE.glob('*/metadata.yaml'))
LARGEST_BYTES = 150_000
CONTENTS = {
    'leg_touchdown': ('leg.yaml', 80, '/coordinator/ground_contact'),
    'rotor_step': ('rig_rotary.yaml', 150, '/rotor/load_cell'),
    'knee_push': ('rig_knee.yaml', 100, '/kfe/load_cell'),
}
"""Run file, ticks, and the topic for which the bag was recorded."""


def test_there_is_a_golden_bag_of_the_leg_and_of_each_rig():
    assert [bag.name for bag in BAGS] == sorted(CONTENTS)


@pytest.mark.golden
@pytest.mark.parametrize('bag', BAGS, ids=lambda bag: bag.name)
def test_golden_bag_replays_bit_for_bit(assert_replays, bag):
    """On any processor: only a changed equation may change a bit."""
    assert_replays(bag)


@pytest.mark.golden
@pytest.mark.parametrize('bag', BAGS, ids=lambda bag: bag.name)
def test_command_replays_golden_bag(bag):
    """`isa replay` as for a user, in a separate process."""
    done = subprocess.run(
        [sys.executable, '-m', 'isa_ros', 'replay', bag],
        cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    n_ticks = CONTENTS[bag.name][1]
    assert f'equal: {n_ticks + 1} ticks, ' in done.stdout
    assert not done.stderr


@pytest.mark.parametrize('bag', BAGS, ids=lambda bag: bag.name)
def test_golden_bag_holds_what_it_is_there_for(bag):
    """A sample at t = 0 and one per tick; the size is small enough for the repository."""
    config, n_ticks, topic = CONTENTS[bag.name]
    read = Bag(bag)
    run = run_of_text(read.provenance.configuration)
    assert run.source == config
    assert (read.start_ns, read.end_ns, read.is_whole) == (0, n_ticks * run.step_ns, True)
    assert sum(message.topic == topic for message in read.messages()) == n_ticks + 1
    assert sum(path.stat().st_size for path in bag.glob('*.mcap')) < LARGEST_BYTES
