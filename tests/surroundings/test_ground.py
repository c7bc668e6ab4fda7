"""Ground: Hunt-Crossley point, no pulling, passivity, friction cone, jit == Python."""

import math

from hypothesis import given, strategies as st
from isa_ros.errors import ParameterError
from isa_ros.surroundings import ground
import pytest
from tests.legs import leg_sheet

SHEET = leg_sheet().ground
ROW = ground.ground_record(SHEET)

depths = st.floats(1e-6, 0.02)
speeds = st.floats(-3.0, 3.0)


def test_static_depth_under_the_falling_weight():
    """L9: 15.2 kg rest at d = (m g / k)^(2/3) with k = 3e6 N/m^1.5."""
    weight = 15.2 * 9.80665
    depth = (weight / 3e6) ** (2.0 / 3.0)
    # Three multiplications, one root and the power above: a few ulps.
    assert ground.normal_force(-depth, 0.0, ROW) == pytest.approx(weight, rel=1e-14)


@given(height=st.floats(-0.05, 0.05), v=st.floats(-100.0, 100.0))
def test_ground_never_pulls(height, v):
    """L9: N >= 0, however fast the foot leaves, and none in the air."""
    force = ground.normal_force(height, v, ROW)
    assert force >= 0.0
    assert height < 0.0 or force == 0.0


@given(depth=depths, v=st.floats(0.01, 3.0))
def test_bounce_loses_energy(depth, v):
    """L9: at the same depth the ground pushes harder on the way in than on the way out."""
    assert ground.normal_force(-depth, -v, ROW) > ground.normal_force(-depth, v, ROW)


@given(normal=st.floats(1e-9, 5e3), z=st.tuples(*[st.floats(-0.01, 0.01)] * 2),
       rate=st.tuples(speeds, speeds))
def test_friction_stays_in_its_cone(normal, z, rate):
    """L11: |F| <= mu N; scaling into the cone rounds by an ulp or two."""
    f_x, f_y = ground.friction_forces(normal, *z, *rate, ROW)
    assert math.hypot(f_x, f_y) <= 0.7 * normal * (1.0 + 1e-15 * 4.0)


@given(angle=st.floats(0.0, 6.28), speed=st.floats(0.05, 3.0))
def test_steady_sliding_is_coulomb_friction_against_the_speed(angle, speed):
    """
    L10, L11: bristles settle where sigma_0 |z| = mu, the force is mu N against v.

    Euler steps of a twentieth of the time constant mu / (sigma_0 v): after 1000 of them the
    start is forgotten by 0.95^1000 = 5e-23.
    """
    v_x, v_y = speed * math.cos(angle), speed * math.sin(angle)
    step = 0.05 * SHEET.bristle_travel_mm * 1e-3 / speed
    z_x = z_y = 0.0
    for _ in range(1000):
        rate_x, rate_y = ground.bristle_rates(z_x, z_y, v_x, v_y, True, ROW)
        z_x, z_y = z_x + step * rate_x, z_y + step * rate_y
    f_x, f_y, normal, _, _ = ground.contact(-0.003, v_x, v_y, 0.0, z_x, z_y, ROW)
    assert f_x == pytest.approx(-0.7 * normal * math.cos(angle), abs=1e-12 * normal)
    assert f_y == pytest.approx(-0.7 * normal * math.sin(angle), abs=1e-12 * normal)


def test_bristles_spring_back_in_the_air():
    """L10: z' = -z / T, T = 5 ms."""
    rate_x, rate_y = ground.bristle_rates(1e-3, -2e-3, 1.0, 1.0, False, ROW)
    assert (rate_x, rate_y) == pytest.approx((-0.2, 0.4), rel=1e-15, abs=0.0)


@given(height=st.floats(-0.02, 0.01), v=st.tuples(speeds, speeds, speeds),
       z=st.tuples(*[st.floats(-0.002, 0.002)] * 2))
def test_compiled_kernel_equals_its_python_source(height, v, z):
    """Replay depends on it: the jit must not reorder a rounding."""
    assert (ground.normal_force(height, v[2], ROW)
            == ground.normal_force.py_func(height, v[2], ROW))
    assert (ground.bristle_rates(*z, v[0], v[1], height < 0.0, ROW)
            == ground.bristle_rates.py_func(*z, v[0], v[1], height < 0.0, ROW))
    assert (ground.friction_forces(100.0, *z, v[0], v[1], ROW)
            == ground.friction_forces.py_func(100.0, *z, v[0], v[1], ROW))


@pytest.mark.parametrize(('name', 'value', 'bound'), [
    ('stiffness', 0.0, '> 0 '), ('damping', -0.1, '>= 0 '), ('friction', 0.0, '>= 0.01 '),
    ('bristle_travel_mm', 0.01, '>= 0.05 '), ('bristle_relaxation_ms', 0.1, '>= 0.5 '),
    ('bristle_damping', -1.0, '>= 0 ')])
def test_a_value_outside_its_range_is_refused(name, value, bound):
    """The message has the parameter and the bound."""
    values = {key: getattr(SHEET, key) for key in SHEET.__dataclass_fields__}
    with pytest.raises(ParameterError, match=f'Ground.{name} = .*must be {bound}'):
        ground.Ground(**(values | {name: value}))
