"""`isa bus canopen` with the example's master, in a network namespace of its own."""

import hashlib
from pathlib import Path
import subprocess
import sys

from benchmarks.bus_ring import missing, NEW_NAMESPACE
from isa_ros.bag.reader import Bag
from isa_ros.bench.child import environment
from isa_ros.replay.replay import replay
import pytest

pytestmark = [
    pytest.mark.slow, pytest.mark.skipif(bool(missing()), reason=f'no namespace: {missing()}')]
DEADLINE_S = 300.0


def ran(directory: Path, n_stalls: int) -> tuple[Path, list[str]]:
    """Run and return the file of messages and the master's lines."""
    ended = subprocess.run(
        [*NEW_NAMESPACE, sys.executable, '-m', 'tests.fieldbus.on_a_can', str(directory),
         str(n_stalls)], env=environment(), stdin=subprocess.DEVNULL, capture_output=True,
        text=True, timeout=DEADLINE_S)
    assert ended.returncode == 0, ended.stderr
    (file,) = (directory / 'bag').glob('*.mcap')
    return file, (directory / 'printed').read_text().splitlines()


@pytest.fixture(scope='module')
def stalled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """Return the run whose master stalls five times for up to 0.3 s."""
    return ran(tmp_path_factory.mktemp('stalled'), 5)


def test_the_example_drives_the_leg_and_recovers_from_a_fault(stalled):
    """A state a cycle of 2 ms; the sensor of the knee is lost from 0.7 s to 0.9 s."""
    assert [line for line in stalled[1] if ' kfe: ' in line] == [
        '    0 kfe: switch on disabled', '    1 kfe: ready to switch on',
        '    2 kfe: switched on', '    3 kfe: operation enabled',
        '  376 kfe: fault, error 0x7300', '  451 kfe: switch on disabled',
        '  452 kfe: ready to switch on', '  453 kfe: switched on',
        '  454 kfe: operation enabled']


def test_the_bag_is_replayed_without_a_master(stalled):
    assert replay(Bag(stalled[0].parent)).is_equal


@pytest.mark.long
def test_stalls_leave_no_trace(stalled, tmp_path: Path):
    free, printed = ran(tmp_path, 0)
    assert printed == stalled[1]
    assert hashlib.sha256(free.read_bytes()).digest() == hashlib.sha256(
        stalled[0].read_bytes()).digest()
