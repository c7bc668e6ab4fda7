"""The position block as an impedance."""

from isa_ros.core.record import rows_of
from isa_ros.reu import impedance
import pytest
from tests.sheets import actuator_sheet

LIMITS = impedance.impedance_record(actuator_sheet('isa_v5').reu.position)


def reference(velocity: float = 0.0, measured: float = 0.0, **values: float) -> float:
    """Return the force reference of a setpoint at position 0 and a measured speed."""
    setpoint = rows_of(1, impedance.SETPOINT)[0]
    for name, value in values.items():
        setattr(setpoint, name, value)
    setpoint.velocity = velocity
    return impedance.force_reference(setpoint, 0.0, measured, LIMITS)


def test_at_rest_it_is_stiffness_times_error_plus_effort():
    """R2: 1e5 N/m times 2 mm plus 50 N."""
    assert reference(
        position=0.002, stiffness=1e5, damping=4000.0, effort=50.0) == pytest.approx(250.0)


def test_it_is_clipped_at_stall_both_ways():
    """R2: 7500 N out, 5174 N in, physics.md errata 15."""
    assert reference(effort=1e6) == 7500.0
    assert reference(effort=-1e6) == -5174.0


def test_damping_acts_on_the_speed_error():
    """R2: 4000 Ns/m times the difference of set and estimated speed."""
    assert reference(velocity=0.1, damping=4000.0) == pytest.approx(400.0)
    assert reference(velocity=0.1, measured=0.3, damping=4000.0) == pytest.approx(-800.0)
