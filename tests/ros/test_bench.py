"""The bench on real nodes: its arithmetic, not its speed."""

from isa_ros.analysis import bench
import pytest

pytestmark = pytest.mark.ros


def test_phases_of_a_run_stay_within_it(monkeypatch, domain):
    """What the coordinator's phases take, the whole run took."""
    monkeypatch.setattr(bench, 'RUN_SECONDS', 0.2)
    factor, phases = bench.leg_run(in_process=True)
    assert set(phases) >= {'actuators', 'recorder', 'leg and supply'}
    assert 0.0 < sum(phases.values()) <= 1e-3 / factor
