"""Recorded runs over every installed peer."""

from benchmarks.peers.catalogue import peer, PEERS
from benchmarks.peers.transport import run_over
from isa_ros.bag.writer import BagWriter
from isa_ros.bench.rigs import request_of
from isa_ros.bench.spec import PROCESSES, Spec
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.local_run import LocalRun
from isa_ros.run.provenance import provenance_of
from isa_ros.run.session import prepare
from isa_ros.tick.source import ScheduledSource
import pytest
from tests.ros.conftest import domain  # noqa: F401

pytestmark = [pytest.mark.ros, pytest.mark.slow]

TICKS = 20


@pytest.mark.parametrize('name', [one.name for one in PEERS])
@pytest.mark.usefixtures('domain')
def test_a_run_over_a_peer_gives_the_same_bag(name, tmp_path):
    """Two real actuators in processes of their own, against direct calls, byte for byte."""
    if not peer(name).is_installed:
        pytest.skip(f'{peer(name).package} is not installed: requirements-bench.txt')
    session = prepare(request_of(Spec('2', PROCESSES, TICKS), tmp_path))
    with StopRequest() as should_stop:
        run_over(peer(name), session, None, should_stop)
    local = LocalRun(session.run)
    expected = tmp_path / 'direct' / 'bag'
    with BagWriter(expected, local.topics, provenance_of(session.scenario)) as bag:
        local.simulate(TICKS, ScheduledSource(session.scenario.commands), bag)
    recorded = session.out / 'bag_0.mcap'
    assert recorded.stat().st_size > TICKS * 2000
    assert recorded.read_bytes() == (expected / 'bag_0.mcap').read_bytes()
