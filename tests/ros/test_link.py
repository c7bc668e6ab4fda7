"""A run over lossy links: one sha256 in memory, in one process, in several, and replayed."""

from collections.abc import Iterator
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.replay.replay import replay
import pytest
from tests.ros.bags import sha256
from tests.ros.domains import held_domain
from tests.ros.started import bringup, LEG

pytestmark = [pytest.mark.ros, pytest.mark.slow]
SECONDS = 0.2
VALUES = {
    'seed': 5, 'link.kind': 'ethercat', 'link.cycle_ms': 0.25, 'link.delay_cycles': 3,
    'link.jitter_us': 100, 'link.loss': 0.2, 'link.watchdog_ms': 4,
    'actuators.hfe.link.loss': 0.5}
OPTIONS = [part for key, value in VALUES.items() for part in ('--set', f'{key}={value}')]


@pytest.fixture(scope='module')
def in_memory(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Return the bag of the run in memory; setpoints change at every tick."""
    run = isa_ros.load(LEG, 'trot_leg').replace(VALUES)
    result = run.simulate(duration=SECONDS)
    assert len(set(result['hfe.link.age'])) > 2
    yield result.save(tmp_path_factory.mktemp('in_memory') / 'bag')


@pytest.mark.parametrize('option', [('--in-process',), ()])
def test_processes_give_the_bag_of_the_run_in_memory(in_memory, option, tmp_path, monkeypatch):
    bag = tmp_path / 'bag'
    with held_domain(monkeypatch), bringup(
            bag, '--scenario', 'trot_leg', '--duration', f'{SECONDS}', *OPTIONS, *option) as run:
        assert run.exit_code() == 0, run.errors
    assert sha256(bag) == sha256(in_memory)


def test_its_replay_is_equal_and_has_the_setpoints_that_were_sent(in_memory):
    bag = Bag(in_memory)
    sent = [each for each in bag.messages() if each.topic == '/hfe/sent_setpoint']
    applied = [each for each in bag.messages() if each.topic == '/hfe/applied_setpoint']
    assert len(sent) > len(applied) > 0
    report = replay(bag)
    assert report.is_equal, report
