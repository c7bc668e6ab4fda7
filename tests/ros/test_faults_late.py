"""Stopped or slow processes: no effect within the time limit, an error with their name beyond."""

from collections.abc import Iterator
import os
from pathlib import Path
import signal

import pytest
from tests.ros.bags import sha256
from tests.ros.domains import held_domain
from tests.ros.faults import (
    assert_replays, Fault, wait_for_chunk, wait_for_tick_0, WHEEL_SINE, with_timeout)
from tests.ros.started import bringup, Started, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
TIMEOUT_S = 0.5
N_STOPS = 5


def stop(pid: int) -> None:
    """Stop a process and wait until it is stopped."""
    os.kill(pid, signal.SIGSTOP)
    wait_for(lambda: ') T ' in Path(f'/proc/{pid}/stat').read_text(), 'the stop')


@pytest.fixture(scope='module', autouse=True)
def stopped_for_long(
        tmp_path_factory: pytest.TempPathFactory, patient_rig: Path,
        ) -> Iterator[tuple[Started, Path]]:
    """Return a run whose coordinator is stopped during the other tests, and its bag."""
    bag = tmp_path_factory.mktemp('stopped') / 'bag'
    with pytest.MonkeyPatch.context() as patch, held_domain(patch), bringup(
            bag, *WHEEL_SINE, '--real-time-factor', '1', config=patient_rig) as run:
        wait_for_tick_0(bag, run)
        stop(run.pid)
        yield run, bag


def test_stopped_actuator_is_named_with_tick_and_time(domain, tmp_path):
    """A stopped process does not answer; it can only be detected by a timeout."""
    bag = tmp_path / 'bag'
    with bringup(bag, config=with_timeout(tmp_path / 'rig.yaml', TIMEOUT_S)) as run:
        wait_for_chunk(bag, run)
        fault = Fault(run, bag)
        os.kill(fault.children['rotor'], signal.SIGSTOP)
        ended = fault.ended(TIMEOUT_S)
    assert ended.exit_code == 3
    last = assert_replays(bag)
    assert f'isa: rotor: no answer to tick {last} after 0.5 s, must come within 0.5 s' in (
        ended.line.replace('0.6 s', '0.5 s'))  # it is checked every 0.1 s


def test_slow_participants_change_nothing(domain, tmp_path, patient_rig, undisturbed):
    """The actuator and the coordinator are late by turns, within the limit."""
    bag = tmp_path / 'bag'
    with bringup(bag, *WHEEL_SINE, '--real-time-factor', '1', config=patient_rig) as run:
        wait_for_tick_0(bag, run)
        for _ in range(N_STOPS):
            for pid in (run.children()['rotor'], run.pid):
                stop(pid)
                os.kill(pid, signal.SIGCONT)
        assert run.exit_code() == 0, run.errors
    assert sha256(bag) == sha256(undisturbed)


def test_a_coordinator_that_was_stopped_for_long_goes_on(stopped_for_long, undisturbed):
    """It is stopped for longer than its actuator waits before it accepts another coordinator."""
    run, bag = stopped_for_long
    wait_for(lambda: 'the coordinator has ended or sent nothing' in run.errors, 'the warning')
    run.signal(signal.SIGCONT)
    assert run.exit_code() == 0, run.errors
    assert sha256(bag) == sha256(undisturbed)
