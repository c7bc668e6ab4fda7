"""`isa bus ethercat` with a real master, in a network namespace of its own."""

from collections.abc import Sequence
import hashlib
import json
from pathlib import Path
import subprocess
import sys
from typing import Any

from benchmarks.bus_ring import missing, NEW_NAMESPACE
from isa_ros.bag.reader import Bag
from isa_ros.bench.child import environment
from isa_ros.replay.replay import recorded_events, replay
from msg_adapters.cdr_reader import decode
import pytest
from sensor_msgs.msg import JointState
from tests.fieldbus import on_a_ring
from tests.fieldbus.on_a_ring import Plan, text_of

pytestmark = [
    pytest.mark.slow, pytest.mark.skipif(bool(missing()), reason=f'no namespace: {missing()}')]
DEADLINE_S = 300.0
TICKS = on_a_ring.ethercat_master.CYCLES


class Ended:
    """A run with its master that has ended."""

    def __init__(self, plan: Plan, found: dict[str, Any]) -> None:
        self.bag = Path(plan.bag)
        self.printed: list[str] = found['printed']
        self.lines: list[str] = found['lines']
        self.lost: int = found['lost']
        self.code: int = found['code']

    @property
    def sha256(self) -> str:
        """Return the digest of the messages' file."""
        (file,) = self.bag.glob('*.mcap')
        return hashlib.sha256(file.read_bytes()).hexdigest()


def ran(tmp_path: Path, plan: Plan, namespace: Sequence[str] = NEW_NAMESPACE) -> Ended:
    """Run slaves and master; fail with the last line of theirs."""
    result = tmp_path / f'{Path(plan.bag).name}.json'
    ended = subprocess.run(
        [*namespace, sys.executable, '-m', 'tests.fieldbus.on_a_ring', text_of(plan),
         str(result)], env=environment(), stdin=subprocess.DEVNULL, capture_output=True,
        text=True, timeout=DEADLINE_S)
    assert ended.returncode == 0, ended.stderr
    return Ended(plan, json.loads(result.read_text()))


def example(
        tmp_path: Path, name: str, namespace: Sequence[str] = NEW_NAMESPACE,
        **more: Any) -> Ended:
    """Run the example's master on the leg, whose knee loses a sensor."""
    return ran(tmp_path, Plan(
        str(tmp_path / name), ('--scenario', 'sensor_lost', '--duration', f'{TICKS * 1e-3:g}'),
        **more), namespace)


@pytest.fixture(scope='module')
def free(tmp_path_factory: pytest.TempPathFactory) -> Ended:
    """Return the run of the example's master, which never waits."""
    return example(tmp_path_factory.mktemp('free'), 'free')


def test_the_example_brings_the_leg_up_moves_it_and_recovers_from_a_fault(free: Ended):
    """Two cycles a state; the trip comes 51 ms after the fault at 0.7 s, which ends at 0.9 s."""
    def of(name: str) -> list[tuple[int, str]]:
        return [(int(line.split()[0]), line.split(': ')[1]) for line in free.printed
                if f' {name}: ' in line]
    up = [(0, 'switch on disabled'), (2, 'ready to switch on'), (4, 'switched on'),
          (6, 'operation enabled')]
    assert of('haa') == of('hfe') == up
    assert of('kfe') == up + [
        (752, 'fault, error 0x7300'), (902, 'switch on disabled'), (904, 'ready to switch on'),
        (906, 'switched on'), (908, 'operation enabled')]
    assert (free.code, free.lost) == (0, 0)
    positions = [decode(message.data, JointState).position[0]
                 for message in Bag(free.bag).messages() if message.topic == '/hfe/joint_states']
    assert max(positions) - min(positions) > 3e-3


def test_the_bag_is_replayed_without_a_master(free: Ended):
    report = replay(Bag(free.bag))
    assert report.is_equal and report.is_whole
    assert report.report.ticks == TICKS + 1


@pytest.mark.ros
def test_nodes_beside_the_bus_change_no_byte(free: Ended, tmp_path: Path):
    assert example(tmp_path, 'with_nodes', has_ros=True).sha256 == free.sha256


def test_a_master_that_stalls_gives_the_same_bytes(free: Ended, tmp_path: Path):
    """Eight times for up to 0.3 s; no watchdog trips, for it counts simulated time."""
    stalled = example(tmp_path, 'stalled', stalls=8)
    assert stalled.sha256 == free.sha256
    assert stalled.printed == free.printed


def test_a_run_under_sched_fifo_gives_the_same_bytes(free: Ended, tmp_path: Path):
    """Without a user namespace, whose root may not use it."""
    namespace = [word for word in NEW_NAMESPACE if word not in ('--user', '--map-root-user')]
    allowed = subprocess.run(
        [*namespace, sys.executable, '-c',
         'import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))'],
        capture_output=True, timeout=DEADLINE_S)
    if allowed.returncode:
        pytest.skip('SCHED_FIFO, or a network namespace of root, is not allowed here')
    assert example(tmp_path, 'first', namespace, is_first=True).sha256 == free.sha256


def test_a_plant_slower_than_the_masters_timeout_changes_nothing(tmp_path: Path):
    """A tenth of real time, and a master that waits 1 ms a frame: most come too late."""
    seconds = f'{on_a_ring.CYCLES * 1e-3:g}'
    fast = ran(tmp_path, Plan(
        str(tmp_path / 'fast'), ('--duration', seconds), is_blind=True, config='rig_linear'))
    slow = ran(tmp_path, Plan(
        str(tmp_path / 'slow'), ('--duration', seconds, '--real-time-factor', '0.1'),
        config='rig_linear', is_blind=True, receive_us=on_a_ring.IMPATIENT_US))
    assert fast.lost == 0 and slow.lost > on_a_ring.CYCLES / 2
    assert slow.sha256 == fast.sha256


def test_a_master_sees_a_pulled_cable_for_its_ticks(tmp_path: Path):
    """The cables connect the knee first and the hip last, which is away from tick 30 to 60."""
    scenario = tmp_path / 'pulled.yaml'
    scenario.write_text('name: pulled\n'
                        f'duration_s: {on_a_ring.CYCLES * 1e-3:g}\nfaults:\n'
                        '- {t_s: 0.03, bus: hfe, set: {pulled: 1}, until_s: 0.06}\n')
    ended = ran(tmp_path, Plan(
        str(tmp_path / 'bag'), ('--scenario', str(scenario), '--order', 'kfe,haa,hfe'),
        is_blind=True))
    assert (ended.code, ended.lost) == (0, 30)
    assert recorded_events(Bag(ended.bag)) == {
        30: ['bus: hfe pulled begins'], 60: ['bus: hfe pulled ends']}
    assert replay(Bag(ended.bag)).is_equal


def test_in_real_time_silence_is_an_event_that_is_replayed(tmp_path: Path):
    """The master ends after 120 cycles; the run once its slave has left operational."""
    ended = ran(tmp_path, Plan(
        str(tmp_path / 'bag'), ('--pace', 'real_time'), is_blind=True, config='rig_linear',
        ends_silent=True))
    bag = Bag(ended.bag)
    ((_, texts),) = recorded_events(bag).items()
    assert texts == ['bus: no process data for 100 ms']
    assert any(' ticks in real time: lateness p50' in line for line in ended.lines)
    assert replay(bag).is_equal
