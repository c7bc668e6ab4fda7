"""The ISA v5 alone: the foot at the piston, and the load cell's resolution."""

import math

from isa_ros.validation import isa_v5
from isa_ros.validation.actuators import SHIPPED
from isa_ros.validation.torque_step import bandwidths
import pytest


def test_the_foot_at_the_piston_is_as_stiff_as_the_levers_make_it():
    """
    Knee at -80 deg: 32.7 mm to the piston, the foot 0.38 m sin(38.7 deg) beside the knee.

    The lever is known to half of its last digit, 0.15 %, and enters squared.
    """
    config = isa_v5.foot(SHIPPED, 'default').config
    ratio = 0.38 * math.sin(math.radians(80.0 - 41.3)) / 32.7e-3
    assert config.load.stiffness == pytest.approx(1e6 * ratio * ratio, rel=3.1e-3)
    assert config.initial_position == pytest.approx((44.5 + 14.1) * 1e-3, abs=0.1e-3)


def test_the_shank_at_the_piston_is_its_inertia_about_the_knee():
    """0.84 (0.02977 + 1.29 c^2) kg m2 with the centre of mass c from the knee, over r^2."""
    about_knee = 0.84 * (0.02977 + 1.29 * (0.1493 ** 2 + 0.0038 ** 2))
    shank = isa_v5.foot(SHIPPED, 'default').config.load.inertia
    assert shank == pytest.approx(about_knee / 32.7e-3 ** 2, rel=0.02)


def test_a_code_of_the_load_cell_is_its_range_over_the_bits():
    """+-10 kN over 12 bit."""
    assert isa_v5.cell_code() == 2e4 / 4096


def test_a_stiffer_stop_is_followed_faster():
    """The oil's spring in series with the stop: the rigid one is the stiffer of both."""
    blocked, rigid = (bandwidths(bench(SHIPPED, 'default'))
                      for bench in (isa_v5.blocked, isa_v5.rigid))
    assert blocked[0] < rigid[0] and blocked[1] < rigid[1]
