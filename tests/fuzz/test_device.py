"""Bad setpoints at any rate leave a running actuator in a defined state."""

from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.errors import SimulationDiverged
import pytest
from tests.fuzz.device_door import fuzz
from tests.fuzz.property import Broken
from tests.sheets import actuator_sheet, smart_actuator

CASES, MANY = 1500, 10_000


def running(model='isa_v5', *variants):
    """Return an actuator on a free load."""
    return smart_actuator(
        model, 'wheel', sheet=actuator_sheet(model, 'default', *variants))


@pytest.mark.parametrize('variants', [(), ('pressure_control',), ('position_control',)])
def test_every_setpoint_leaves_a_defined_state_and_one_line_at_most(variants):
    assert CASES // 4 < fuzz(running('isa_v5', *variants), CASES, 1) < CASES


@pytest.mark.long
@pytest.mark.parametrize('model', ['isa_v2', 'smart_manifold', 'isa_v5'])
def test_every_one_of_many_setpoints_leaves_a_defined_state(model):
    fuzz(running(model), MANY, 2)


def test_the_range_that_is_missing_is_found(monkeypatch):
    """Without it a huge setpoint reaches the loops."""
    monkeypatch.setattr(SetpointRange, 'admit', lambda own, command, mode: '')
    with pytest.raises((Broken, SimulationDiverged, AssertionError)):
        lines = fuzz(running(), CASES, 1)
        assert lines > CASES // 2
