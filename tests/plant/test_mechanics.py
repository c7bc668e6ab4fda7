"""Force sensor, play and end stops."""

from hypothesis import given, strategies as st
from isa_ros.core.contact import one_sided
from isa_ros.plant import mechanics
import pytest
from tests.sheets import plant_row

ROTOR = plant_row('smart_manifold').mechanics


def test_sensor_reads_the_spring_and_its_damping():
    """M2: 1 mrad of twist and 1 rad/s of difference read 20 + 2 Nm."""
    assert mechanics.sensor_force(0.001, 1.0, 0.0, 0.0, ROTOR) == pytest.approx(22.0)


def test_the_sensor_pulls_as_it_pushes():
    """M2: the torque sensor is not a one-sided contact."""
    assert mechanics.sensor_force(0.0, 0.0, 0.001, 0.0, ROTOR) == pytest.approx(-20.0)


@given(d=st.floats(-0.01, 0.01), j=st.floats(1e-6, 1e-3))
def test_play_is_odd_and_takes_at_most_the_gap(d, j):
    """M1: |phi(d)| lies between |d| - j and |d|."""
    stretch = mechanics.play(d, j)
    assert stretch == -mechanics.play(-d, j)
    assert abs(d) - j <= abs(stretch) + 1e-18
    assert abs(stretch) <= abs(d)
    assert mechanics.play(d, 0.0) == d


@given(depth=st.floats(-0.1, 0.1), rate=st.floats(-10.0, 10.0))
def test_a_contact_never_pulls(depth, rate):
    """M3: no force without contact, never a negative one."""
    force = one_sided(depth, rate, 5e4, 20.0)
    assert force >= 0.0
    assert depth > 0.0 or force == 0.0


def test_own_stops_push_back_into_the_range():
    """M3: positive below 0, negative beyond the stroke, zero between."""
    assert mechanics.stop_force(-0.001, 0.0, 1.745, ROTOR) == pytest.approx(50.0)
    assert mechanics.stop_force(1.746, 0.0, 1.745, ROTOR) == pytest.approx(-50.0)
    assert mechanics.stop_force(0.9, 5.0, 1.745, ROTOR) == 0.0


def test_own_stops_damp_what_runs_into_them():
    """M3: 20 Nms/rad against the speed into the stop, plus 50 Nm; less when leaving it."""
    assert mechanics.stop_force(-0.001, -1.0, 1.745, ROTOR) == pytest.approx(70.0)
    assert mechanics.stop_force(-0.001, 1.0, 1.745, ROTOR) == pytest.approx(30.0)
    assert mechanics.stop_force(1.746, 1.0, 1.745, ROTOR) == pytest.approx(-70.0)
    assert mechanics.stop_force(1.746, -1.0, 1.745, ROTOR) == pytest.approx(-30.0)
