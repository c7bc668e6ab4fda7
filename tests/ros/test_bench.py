"""The bench on real nodes: positive and consistent rows; speeds are not tested."""

from isa_ros.bench.loading import median_loading
from isa_ros.bench.rounds import measured
from isa_ros.bench.spec import ACTUATORS, COORDINATOR, LEG, Measured, ONE_PROCESS, PROCESSES, Spec
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

MIB = 1024 * 1024


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


def test_what_an_actuator_loads_adds_up_to_its_start(monkeypatch):
    """A start may be slower than the next by more than they differ: no time is compared."""
    monkeypatch.setattr('isa_ros.bench.loading.REPEATS', 1)
    loads = median_loading()
    assert min(loads.floor, loads.imports, loads.kernels) > 0.0
    assert loads.imports + loads.kernels == pytest.approx(loads.whole, abs=1e-6)
    assert loads.floor_bytes > 30 * MIB
