"""
One run with disturbed sensors, faults and lossy links, seven ways of running it, one sha256.

The reference is one process; each of the other ways is compared with it.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
import math
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
import time

import pytest
from tests.disturbed import disturbed_run, OPTIONS, SEED as RUN_SEED, TICKS
from tests.ros.bags import sha256
from tests.ros.domains import held_domain
from tests.ros.hosts import ADDRESSES, Host, two_hosts, two_lossy_hosts, why_no_hosts
from tests.ros.started import bringup, DROP, LEG, started, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
RUN = ('--scenario', str(DROP), '--duration', f'{TICKS * 1e-3}', '--join-timeout', '100',
       *OPTIONS, '--seed', str(RUN_SEED))
CORES = 2
STOP_S = 2.0  # less than the leg's tick_timeout_s
LOSS, SEED = 0.01, 4


def record(bag: Path, *options: str, prefix: Sequence[str] = ()) -> None:
    """Record the run to its end."""
    with bringup(bag, *RUN, *options, prefix=prefix) as run:
        assert run.exit_code() == 0, run.errors


def in_processes(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record(bag)


def with_loaded_cores(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with ExitStack() as stack:
        for _ in range(CORES):
            busy = subprocess.Popen([sys.executable, '-c', 'while True: pass'])
            stack.callback(busy.wait)
            stack.callback(busy.kill)
        record(bag)


def with_a_stopped_actuator(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with bringup(bag, *RUN, '--real-time-factor', '0.2') as run:
        wait_for(lambda: (bag / 'metadata.yaml').exists() or not run.is_running(), 'tick 0')
        actuator = run.children()['hfe']
        os.kill(actuator, signal.SIGSTOP)
        threading.Timer(STOP_S, os.kill, (actuator, signal.SIGCONT)).start()
        stopped = time.monotonic()
        assert run.exit_code() == 0, run.errors
        assert time.monotonic() - stopped > STOP_S  # else it was stopped after its last tick


def with_actuators_on(host: Host, bag: Path, own: Host) -> None:
    """Record on one host with all actuators on another, where a signal is their normal end."""
    with started(bag.with_name('actuators.log'), 'isa_ros', 'actuators', str(LEG),
                 '--scenario', str(DROP), *OPTIONS, '--set', f'seed={RUN_SEED}',
                 prefix=host.enter) as actuators:
        record(bag, '--elsewhere', 'all', prefix=own.enter)
        actuators.signal(signal.SIGTERM)
        assert actuators.exit_code() == 0, actuators.errors


def on_two_hosts(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    with two_hosts() as (first, second):
        with_actuators_on(second, bag, first)


def on_two_hosts_with_loss(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without multicast: each host has the other's address."""
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    monkeypatch.setenv('ROS_STATIC_PEERS', ';'.join(ADDRESSES))
    with two_lossy_hosts(bag.with_name('relay.log'), LOSS, SEED) as (first, second, relay):
        with_actuators_on(second, bag, first)
        forwarded, dropped = relay.end()
    frames = forwarded + dropped
    assert frames > 6 * TICKS  # a step and an answer for each of three actuators
    # Five standard deviations of the binomial distribution.
    assert abs(dropped - LOSS * frames) < 5.0 * math.sqrt(LOSS * frames)


def in_memory(bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without nodes, from Python."""
    disturbed_run().simulate().save(bag)


WAYS = (in_memory, in_processes, with_loaded_cores, with_a_stopped_actuator, on_two_hosts,
        on_two_hosts_with_loss)
NEEDS_HOSTS = (on_two_hosts, on_two_hosts_with_loss)


@pytest.fixture(scope='module')
def found(tmp_path_factory: pytest.TempPathFactory,
          request: pytest.FixtureRequest) -> Iterator[dict[str, str]]:
    """Return the sha256 of the run in one process; each way adds its own; print all at the end."""
    bag = tmp_path_factory.mktemp('in_one_process') / 'bag'
    with pytest.MonkeyPatch.context() as patch, held_domain(patch), \
            bringup(bag, *RUN, '--in-process') as run:
        assert run.exit_code() == 0, run.errors
    hashes = {'in_one_process': sha256(bag)}
    yield hashes
    capture = request.config.pluginmanager.get_plugin('capturemanager')
    with capture.global_and_fixture_disabled():
        print(f'\n{as_text(hashes)}')


def as_text(hashes: dict[str, str]) -> str:
    """Return one line for each sha256, with the ways that gave it."""
    return '\n'.join(
        f'sha256 {one}: {", ".join(way for way, other in hashes.items() if other == one)}'
        for one in dict.fromkeys(hashes.values()))


@pytest.mark.parametrize('way', WAYS)
def test_every_way_of_running_gives_one_sha256(
        domain: int, found: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        way: Callable[[Path, pytest.MonkeyPatch], None]) -> None:
    if way in NEEDS_HOSTS and (reason := why_no_hosts()) is not None:
        pytest.skip(f'no network namespaces here: {reason}')
    way(tmp_path / 'bag', monkeypatch)
    found[way.__name__] = sha256(tmp_path / 'bag')
    assert len(set(found.values())) == 1, as_text(found)
