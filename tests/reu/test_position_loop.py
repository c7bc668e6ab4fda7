"""Impedance and speed estimate."""

import math

from isa_ros.reu import position_loop
import numpy as np
import pytest
from tests.sheets import actuator_sheet

SHEET = actuator_sheet('isa_v5').reu.position
LOOP = np.array([position_loop.position_loop_record(SHEET)], position_loop.POSITION_LOOP)[0]


def fresh(**setpoint: float) -> tuple[np.record, np.record]:
    """Return (setpoint, state) records."""
    wanted = np.zeros(1, position_loop.SETPOINT).view(np.recarray)[0]
    for name, value in setpoint.items():
        setattr(wanted, name, value)
    return wanted, np.zeros(1, position_loop.POSITION_STATE).view(np.recarray)[0]


def test_impedance_at_rest_is_stiffness_times_error_plus_effort():
    """R2: 1e5 N/m times 2 mm plus 50 N."""
    setpoint, state = fresh(position=0.002, stiffness=1e5, damping=4000.0, effort=50.0)
    position_loop.position_loop_step(0.0, setpoint, LOOP, state)
    assert state.force_reference == pytest.approx(250.0)


def test_reference_is_clipped_at_stall_both_ways():
    """R2: 7500 N out, 5174 N in, physics.md errata 15."""
    setpoint, state = fresh(effort=1e6)
    position_loop.position_loop_step(0.0, setpoint, LOOP, state)
    assert state.force_reference == 7500.0
    setpoint.effort = -1e6
    position_loop.position_loop_step(0.0, setpoint, LOOP, state)
    assert state.force_reference == -5174.0


def test_speed_estimate_follows_a_ramp_through_its_filter():
    """R1: a ramp's difference through 100 Hz at 1 kHz settles exponentially to its slope."""
    setpoint, state = fresh()
    for n in range(1, 30):
        position_loop.position_loop_step(0.3e-3 * n, setpoint, LOOP, state)
        expected = 0.3 * (1.0 - math.exp(-2.0 * math.pi * 0.1 * n))
        assert state.velocity == pytest.approx(expected, rel=1e-9)


def test_damping_acts_on_the_speed_error():
    """R2: 4000 Ns/m times the difference of set and estimated speed."""
    setpoint, state = fresh(velocity=0.1, damping=4000.0)
    position_loop.position_loop_step(0.0, setpoint, LOOP, state)
    assert state.force_reference == pytest.approx(400.0)
