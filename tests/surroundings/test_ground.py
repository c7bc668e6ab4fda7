"""Ground: Hunt-Crossley point, no pulling, friction cone, sticking, sliding, jit == Python."""

import math

from hypothesis import given, strategies as st
from isa_ros.errors import ParameterError
from isa_ros.surroundings import ground
import pytest
from tests.legs import leg_sheet
from tests.sheets import override

SHEET = leg_sheet().ground
ROW = ground.ground_record(SHEET)

depths = st.floats(1e-6, 0.02)
speeds = st.floats(-3.0, 3.0)
shears = st.tuples(*[st.floats(-0.01, 0.01)] * 2)
shears = st.tuples(*[st.floats(-0.01, 0.01)] * 2)


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


@given(normal=st.floats(1e-9, 5e3), shear=shears, v=st.tuples(speeds, speeds))
def test_friction_stays_in_its_cone(normal, shear, v):
    """L10: |F| <= mu N; scaling into the cone rounds by an ulp or two."""
    f_x, f_y = ground.friction_forces(normal, *shear, *v, ROW)
    assert math.hypot(f_x, f_y) <= 0.7 * normal * (1.0 + 1e-15 * 4.0)


@given(angle=st.floats(0.0, 6.28), speed=st.floats(0.001, 30.0), normal=st.floats(1.0, 5e3))
def test_a_sole_sheared_along_its_way_slides_with_exactly_the_friction(angle, speed, normal):
    """L10, L11: with k_t z = mu N along v, G is longer than mu N at any speed, and z' = 0."""
    shear = 0.7 * normal / SHEET.tangential_stiffness
    along = math.cos(angle), math.sin(angle)
    z_x, z_y = (shear * e for e in along)
    v_x, v_y = (speed * e for e in along)
    f_x, f_y = ground.friction_forces(normal, z_x, z_y, v_x, v_y, ROW)
    # Root, quotient and product round by an ulp each.
    assert f_x == pytest.approx(-0.7 * normal * along[0], abs=1e-15 * normal)
    assert f_y == pytest.approx(-0.7 * normal * along[1], abs=1e-15 * normal)
    rates = ground.shear_rates(f_x, f_y, z_x, z_y, ROW)
    assert rates == pytest.approx((0.0, 0.0), abs=4e-15 * normal / SHEET.tangential_damping)


@given(angle=st.floats(0.0, 6.28), speed=st.floats(0.5, 3.0))
def test_a_foot_dragged_from_rest_ends_in_coulomb_friction_against_its_speed(angle, speed):
    """
    L10, L11: from any shear the friction turns against v, mu N strong.

    Shear across v falls with the way by exp(-k_t s/(mu N)) or faster, and along v within
    c_t/k_t: after 40 times both the start is forgotten by e^-40 = 4e-18.
    """
    v_x, v_y = speed * math.cos(angle), speed * math.sin(angle)
    normal = ground.normal_force(-0.003, 0.0, ROW)
    time = 40.0 * (0.7 * normal / SHEET.tangential_stiffness / speed
                   + SHEET.tangential_damping / SHEET.tangential_stiffness)
    step = 0.5 * SHEET.tangential_damping / SHEET.tangential_stiffness
    z_x, z_y = 1e-3, -1e-3
    for _ in range(math.ceil(time / step)):
        _, _, _, rate_x, rate_y = ground.contact(-0.003, v_x, v_y, 0.0, z_x, z_y, ROW)
        z_x, z_y = z_x + step * rate_x, z_y + step * rate_y
    f_x, f_y, _, _, _ = ground.contact(-0.003, v_x, v_y, 0.0, z_x, z_y, ROW)
    assert f_x == pytest.approx(-0.7 * normal * math.cos(angle), abs=1e-12 * normal)
    assert f_y == pytest.approx(-0.7 * normal * math.sin(angle), abs=1e-12 * normal)


@given(shear=st.tuples(*[st.floats(-1e-4, 1e-4)] * 2), v=st.tuples(*[st.floats(-0.05, 0.05)] * 2))
def test_a_sticking_sole_is_spring_and_damper(shear, v):
    """L10, L11 inside the cone (20 N of 700): F = -(k_t z + c_t v) and z' = v, whatever N."""
    forces = ground.friction_forces(1e3, *shear, *v, ROW)
    assert forces == ground.friction_forces(2e3, *shear, *v, ROW)
    for f, z, speed in zip(forces, shear, v):
        assert f == pytest.approx(-(1e5 * z + 15.0 * speed), abs=1e-14)
    # F and k_t z are below 20 N, and each rounds by 2e-16 of itself.
    assert ground.shear_rates(*forces, *shear, ROW) == pytest.approx(v, abs=1e-14 / 15.0)


@given(height=st.floats(-0.02, 0.0), v=st.tuples(speeds, speeds, speeds), shear=shears,
       angle=st.floats(0.0, 6.28))
def test_friction_does_not_depend_on_the_direction(height, v, shear, angle):
    """L10, L11: turned speeds and shear give the turned force and rates."""
    def turned(x, y):
        return (math.cos(angle) * x - math.sin(angle) * y,
                math.sin(angle) * x + math.cos(angle) * y)
    f_x, f_y, normal, rate_x, rate_y = ground.contact(height, *v, *shear, ROW)
    again = ground.contact(height, *turned(v[0], v[1]), v[2], *turned(*shear), ROW)
    # G is below 1500 N and is turned within 1e-15 of itself; a rate is that over c_t = 15.
    assert again[:2] == pytest.approx(turned(f_x, f_y), abs=1e-11)
    assert again[3:] == pytest.approx(turned(rate_x, rate_y), abs=1e-12)
    assert again[2] == normal


def test_the_sole_springs_back_in_the_air():
    """L11: z' = -z k_t/c_t without a force, whatever the speed; c_t/k_t = 0.15 ms."""
    force_x, force_y, _, rate_x, rate_y = ground.contact(0.01, 1.0, 1.0, 0.0, 1e-3, -2e-3, ROW)
    assert (force_x, force_y) == (0.0, 0.0)
    assert (rate_x, rate_y) == pytest.approx((-1e-3 / 1.5e-4, 2e-3 / 1.5e-4), rel=1e-15, abs=0.0)


@given(height=st.floats(-0.02, 0.01), v=st.tuples(speeds, speeds, speeds), shear=shears)
def test_compiled_kernel_equals_its_python_source(height, v, shear):
    """Replay depends on it: the jit must not reorder a rounding."""
    normal = ground.normal_force(height, v[2], ROW)
    assert normal == ground.normal_force.py_func(height, v[2], ROW)
    forces = ground.friction_forces(normal, *shear, v[0], v[1], ROW)
    assert forces == ground.friction_forces.py_func(normal, *shear, v[0], v[1], ROW)
    assert (ground.shear_rates(*forces, *shear, ROW)
            == ground.shear_rates.py_func(*forces, *shear, ROW))


@pytest.mark.parametrize(('name', 'value', 'bound'), [
    ('stiffness', 0.0, '> 0 '), ('damping', -0.1, '>= 0 '), ('friction', 0.0, '>= 0.01 '),
    ('tangential_stiffness', 999.0, '>= 1000 '), ('tangential_stiffness', 1.1e7, '<= 1e\\+07 '),
    ('tangential_damping', 0.0, '>= 1 ')])
def test_a_value_outside_its_range_is_refused(name, value, bound):
    """The message has the parameter and the bound."""
    values = {key: getattr(SHEET, key) for key in SHEET.__dataclass_fields__}
    with pytest.raises(ParameterError, match=f'Ground.{name} = .*must be {bound}'):
        ground.Ground(**(values | {name: value}))


def test_a_sole_faster_than_the_steps_of_a_leg_is_refused():
    """L11: c_t/k_t below a step of 0.1 ms is not resolved; 15 N s/m over 1e6 N/m are 15 us."""
    with pytest.raises(ParameterError, match=(
            r'Ground\.tangential_damping = 15 N s/m, must be >= 100 N s/m, 0\.0001 s of '
            r'Ground\.tangential_stiffness = 1e\+06 N/m')):
        override(SHEET, 'tangential_stiffness', 1e6)
