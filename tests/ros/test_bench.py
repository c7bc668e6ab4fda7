"""The bench on real nodes: positive and consistent rows; speeds are not tested."""

from isa_ros.bag.provenance import provenance_of
from isa_ros.bag.writer import BagWriter
from isa_ros.bench.loading import median_loading
from isa_ros.bench.peers.catalogue import peer, PEERS
from isa_ros.bench.peers.transport import run_over
from isa_ros.bench.rigs import request_of
from isa_ros.bench.rounds import measured
from isa_ros.bench.spec import ACTUATORS, COORDINATOR, LEG, Measured, ONE_PROCESS, PROCESSES, Spec
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.local_run import Inputs, LocalRun
from isa_ros.run.session import prepare
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

MIB = 1024 * 1024
TICKS = 20


@pytest.mark.parametrize('way, n_processes', [(ONE_PROCESS, 1), (PROCESSES, 4)])
def test_a_run_tells_speed_phases_start_up_and_memory(way, n_processes, domain):
    """Phases are parts of the tick; every process has the memory of an interpreter at least."""
    run = measured(Spec(LEG, way, 200))
    assert isinstance(run, Measured), run
    assert set(run.phases) >= {'actuators', 'recorder', 'body and supplies'}
    assert 0.0 < sum(run.phases.values()) <= run.tick
    assert list(run.startup)[0] == 'interpreter' and 0.5 < sum(run.startup.values()) < 120.0
    assert len(run.memory) == n_processes
    assert all(10 * MIB < size.proportional <= size.resident < 1000 * MIB
               for size in run.memory)
    assert set(run.processor) == ({COORDINATOR, ACTUATORS} if n_processes > 1 else {COORDINATOR})
    assert run.processor[COORDINATOR] > 0.0


def test_what_an_actuator_loads_is_more_than_the_floor(monkeypatch):
    monkeypatch.setattr('isa_ros.bench.loading.REPEATS', 1)
    loads = median_loading()
    assert 0.0 < loads.floor < loads.imports
    assert loads.kernels > 0.0 and loads.floor_bytes > 30 * MIB


@pytest.mark.parametrize('name', [one.name for one in PEERS])
def test_a_run_over_a_peer_gives_the_same_bag(name, tmp_path, domain):
    """Two real actuators in processes of their own, against direct calls, byte for byte."""
    if not peer(name).is_installed:
        pytest.skip(f'{peer(name).package} is not installed: requirements-bench.txt')
    session = prepare(request_of(Spec('2', PROCESSES, TICKS), tmp_path))
    with StopRequest() as should_stop:
        run_over(peer(name), session, None, should_stop)
    local = LocalRun(session.run)
    expected = tmp_path / 'direct' / 'bag'
    with BagWriter(expected, local.topics, provenance_of(session.scenario)) as bag:
        local.simulate(TICKS, Inputs(session.scenario.commands), bag)
    recorded = session.out / 'bag_0.mcap'
    assert recorded.stat().st_size > TICKS * 2000
    assert recorded.read_bytes() == (expected / 'bag_0.mcap').read_bytes()
