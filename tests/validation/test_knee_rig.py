"""The knee rig's checks: ground, edges and the fall evaluated from a run."""

import math

from isa_ros.scripting.run import load
from isa_ros.validation import knee_rig
from isa_ros.validation.actuators import SHIPPED
import numpy as np
import pytest


def test_the_ground_alone_is_replaced():
    wood, rubber = (
        knee_rig.on_ground(SHIPPED, material, 'force_step_low', 'default').configuration
        for material in ('wood', 'rubber'))
    assert rubber.leg.sheet.ground.stiffness == 1e6 != wood.leg.sheet.ground.stiffness
    assert rubber.leg.sheet.body == wood.leg.sheet.body


def test_the_gains_are_those_of_the_knee_alone():
    """The hip joints keep the gains that hold them."""
    read, retuned = (knee_rig.of_preset(SHIPPED, 'rig_knee', 'drop', gains).configuration
                     for gains in ('table_4', 'default'))
    assert read.actuator('kfe').sheet.reu.force.kf == 0.006
    assert retuned.actuator('kfe').sheet.reu.force.kf != 0.006
    assert read.actuator('hfe') == retuned.actuator('hfe')


def test_both_edges_of_a_force_step_are_measured_against_their_own_change():
    """200 to 500 N and back, 10 % over at the first and 20 % at the second."""
    force = np.full(1000, 200.0)
    force[300:700] = 500.0
    force[310:320] = 530.0
    force[710:720] = 140.0
    up, down = knee_rig.edges(np.arange(1000) * 1e-3, force, 'low')
    assert up.overshoot == pytest.approx(0.1) and down.overshoot == pytest.approx(0.2)
    assert up.steady_error == down.steady_error == 0.0


def test_errors_are_those_of_the_settled_periods():
    """A shift by 1 mm of a sine of 10 mm from 1.1 s on: the transient before has no influence."""
    t = np.arange(3000) * 1e-3
    wanted = 10e-3 * np.sin(2.0 * math.pi * t)
    measured = wanted + np.where(t < 1.1, 5e-3, 1e-3)
    position, force = knee_rig.tracking({
        'kfe.position': measured, 'kfe.position_reference': wanted,
        'kfe.force': np.full(3000, 3.0), 'kfe.force_reference': np.zeros(3000)}, t, 'kfe')
    assert position == pytest.approx(10.0) and force == pytest.approx(3.0)


def test_a_leg_that_never_lands_has_no_time_of_fall():
    assert math.isnan(knee_rig.touchdown(np.arange(1000) * 1e-3, np.zeros(1000)))


def test_the_fall_takes_as_long_as_a_free_one():
    """
    10 cm at g take 143 ms.

    Until its release the leg sags by 3 mm under its impedance, 2 ms at 1.4 m/s, and contact
    is detected at ticks of 1 ms.
    """
    drop = load('rig_knee', 'drop').simulate(0.3)
    fall = knee_rig.touchdown(drop.time, knee_rig.ground_force(drop))
    assert fall == pytest.approx(math.sqrt(2.0 * 0.1 / 9.80665), abs=3e-3)
