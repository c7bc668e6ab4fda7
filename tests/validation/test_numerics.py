"""The checks of the solver: the allowed error at a kink, and the differences compared."""

from isa_ros.analysis.accuracy.agreement import Difference
from isa_ros.validation import numerics
import pytest


def test_the_bound_of_a_kink_is_that_of_the_valve_and_its_chamber():
    """
    Smart manifold: 1.1704 m2/s at 3.5 MPa, 4.47 mm/s of spool, 8.5 ml at 700 MPa, 20 us.

    1.1704 sqrt(10.35/3.5) 4.473e-3 7e8/8.495e-6 (20e-6)^2/8 Pa of 20.7 MPa; the slope is known
    to five digits.
    """
    jump = 1.17041 * (10.35 / 3.5) ** 0.5 * 4.4736e-3 * 7e8 / 8.4948e-6
    assert numerics.kink('smart_manifold') == pytest.approx(
        jump * 400e-12 / 8.0 / 20.7e6, rel=1e-3)


def test_the_worst_of_the_named_states_counts():
    found = [Difference('sine', 'wheel', state, relative) for state, relative in (
        ('plant.chambers.p_a', 1e-6), ('plant.friction.bristle', 1e-4))]
    assert numerics.worst(found) == 1e-4
    assert numerics.worst(found, ('plant.chambers.p_a',)) == 1e-6
