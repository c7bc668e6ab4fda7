"""Any process of a run is killed: it is reported at once, and the bag can be used."""

from collections.abc import Iterator
import os
from pathlib import Path
import signal
from typing import NamedTuple

import pytest
from tests.ros.bags import mcap_file
from tests.ros.domains import held_domain
from tests.ros.faults import (
    assert_last_second_lost_at_most, assert_replays, ClockListener, Fault, KILL_SEEN_S,
    wait_for_chunk)
from tests.ros.started import actuator, bringup, coordinator, is_alive, RIG, Started, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]


class Abandoned(NamedTuple):
    """An actuator whose coordinator was killed, the bag of their run, and their domain."""

    rotor: Started
    bag: Path
    domain: int


@pytest.fixture(scope='module', autouse=True)
def abandoned(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Abandoned]:
    """Kill the coordinator of an actuator, which waits for it during the other tests."""
    folder = tmp_path_factory.mktemp('abandoned')
    bag = folder / 'bag'
    with pytest.MonkeyPatch.context() as patch, held_domain(patch) as domain, actuator(
            folder / 'rotor.log', 'rotor', config_file=RIG, lockstep=True) as rotor:
        with coordinator(folder / 'first.log', config_file=RIG, out=bag) as first:
            wait_for_chunk(bag, first)
            first.signal(signal.SIGKILL)
            assert first.exit_code() == -signal.SIGKILL
        yield Abandoned(rotor, bag, domain)


@pytest.mark.parametrize('name', ['haa', 'kfe'])
def test_killed_actuator_ends_the_run_naming_it(domain, tmp_path, name):
    """The first and the last actuator of a leg."""
    bag = tmp_path / 'bag'
    with bringup(bag) as run:
        wait_for_chunk(bag, run)
        fault = Fault(run, bag)
        assert sorted(fault.children) == ['haa', 'hfe', 'kfe']
        pid = fault.children[name]
        os.kill(pid, signal.SIGKILL)
        ended = fault.ended(KILL_SEEN_S)
    assert ended.exit_code == 3
    last = assert_replays(bag)
    assert ended.line == (
        f'isa: {name}: its process {pid} was ended by SIGKILL in tick {last}')


@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_killed_run_loses_its_last_second_at_most(domain, tmp_path, observer, options):
    """One actuator is stopped at that moment, so that it cannot end by itself."""
    bag, clock = tmp_path / 'bag', ClockListener(observer)
    with bringup(bag, *options, config=RIG) as run:
        wait_for_chunk(bag, run)
        wait_for(clock.latest_ns, 'the time')
        fault = Fault(run, bag)
        for pid in fault.children.values():
            os.kill(pid, signal.SIGSTOP)
        run.signal(signal.SIGKILL)
        assert run.exit_code() == -signal.SIGKILL
        wait_for(lambda: not any(map(is_alive, fault.pids)), 'their end')
    assert_last_second_lost_at_most(bag, clock.latest_ns())
    assert_replays(bag, is_whole=False)


def test_actuators_of_a_killed_coordinator_serve_the_next(abandoned, tmp_path, monkeypatch):
    """Actuators started by hand wait; the first bag is complete up to its last chunk."""
    (rotor, bag, domain), next_bag = abandoned, tmp_path / 'next'
    monkeypatch.setenv('ROS_DOMAIN_ID', str(domain))
    wait_for(lambda: 'coordinator has ended or sent nothing' in rotor.errors, 'the warning')
    with coordinator(tmp_path / 'second.log', config_file=RIG, out=next_bag,
                     duration=0.05) as second:
        assert second.exit_code() == 0, second.errors
    assert rotor.is_running()
    assert_replays(bag, is_whole=False)
    assert assert_replays(next_bag) == 50
    assert mcap_file(next_bag).stat().st_size < mcap_file(bag).stat().st_size
