"""
Energy of the foot on the ground: what the contact gives back it has taken before.

The foot is led along closed random paths, some within the ground and some with lift-off and
touch-down, so that the normal force varies between nothing and kilonewtons while the sole sticks,
yields and slides. Work is what the foot does on the ground.
"""

import math

from hypothesis import given, strategies as st
from isa_ros.core.kernel import kernel
from isa_ros.surroundings import ground
import numpy as np
import pytest
from tests.legs import leg_sheet
from tests.sheets import override

SHEET = leg_sheet().ground
ROW = ground.ground_record(SHEET)
STEP = 0.1e-3   # s, of a leg's Runge-Kutta method
PERIOD = 0.1    # s, of the paths
STEPS = 2000    # of two periods
PATHS = range(100)

speeds = st.floats(-3.0, 3.0)
shears = st.tuples(*[st.floats(-0.01, 0.01)] * 2)


def closed_path(seed: int) -> np.ndarray:
    """Return the coefficients of two harmonics along x, y and z, and those at rest, (3, 5)."""
    rng = np.random.default_rng(seed)
    along = 10.0 ** rng.uniform(-4.5, -2.5)  # m
    path = rng.uniform(-1.0, 1.0, (3, 5)) * np.array((along, along, 1.5e-3))[:, None]
    path[:, 4] = 0.0, 0.0, rng.uniform(-2e-3, 1e-3)
    return path


@kernel
def foot(path, t):
    """Return the foot's height (m) and its velocities (m/s)."""
    w = 2.0 * math.pi / PERIOD
    s_1, c_1, s_2, c_2 = math.sin(w * t), math.cos(w * t), math.sin(2 * w * t), math.cos(2 * w * t)
    p = path[2]
    height = p[0] * s_1 + p[1] * c_1 + p[2] * s_2 + p[3] * c_2 + p[4]
    v_x, v_y, v_z = [
        w * (p[0] * c_1 - p[1] * s_1 + 2.0 * (p[2] * c_2 - p[3] * s_2)) for p in path]
    return height, v_x, v_y, v_z


@kernel
def rates(path, t, shear_x, shear_y, row):
    """Return the rates of shear x and y, and the powers along and across the ground."""
    height, v_x, v_y, v_z = foot(path, t)
    f_x, f_y, normal, rate_x, rate_y = ground.contact(
        height, v_x, v_y, v_z, shear_x, shear_y, row)
    return rate_x, rate_y, -(f_x * v_x + f_y * v_y), -normal * v_z


@kernel
def lead(path, row, works, throughput):
    """Fill the works along and across the ground and the sums of their sizes, J, (n, 2)."""
    h, x, y = STEP, 0.0, 0.0
    depth = max(0.0, -foot(path, 0.0)[0])
    work = (0.0, 0.4 * row.stiffness * depth * depth * math.sqrt(depth))
    flowed = (0.0, 0.0)
    for n in range(len(works)):
        a = rates(path, n * h, x, y, row)
        b = rates(path, (n + 0.5) * h, x + 0.5 * h * a[0], y + 0.5 * h * a[1], row)
        c = rates(path, (n + 0.5) * h, x + 0.5 * h * b[0], y + 0.5 * h * b[1], row)
        d = rates(path, (n + 1) * h, x + h * c[0], y + h * c[1], row)
        x += h / 6.0 * (a[0] + 2.0 * (b[0] + c[0]) + d[0])
        y += h / 6.0 * (a[1] + 2.0 * (b[1] + c[1]) + d[1])
        work = (work[0] + h / 6.0 * (a[2] + 2.0 * (b[2] + c[2]) + d[2]),
                work[1] + h / 6.0 * (a[3] + 2.0 * (b[3] + c[3]) + d[3]))
        flowed = flowed[0] + h * abs(a[2]), flowed[1] + h * abs(a[3])
        works[n, 0], works[n, 1] = work
        throughput[n, 0], throughput[n, 1] = flowed


@pytest.mark.parametrize('changes', [
    {}, {'tangential_stiffness': 1e4}, {'tangential_damping': 1e3}, {'friction': 0.1}],
    ids=str)
def test_the_ground_never_gives_back_more_than_it_took(changes: dict[str, float]) -> None:
    """
    L9 to L11: what was stored at the start plus the work done on the ground is never negative.

    Neither along the ground nor across it, at any instant of two periods; at the start 2/5 k
    d^2.5 are stored across it and nothing along it. Sums of 2000 steps round by 2000 ulps.
    """
    sheet = SHEET
    for name, value in changes.items():
        sheet = override(sheet, name, value)
    row = ground.ground_record(sheet)
    moved = 0.0
    for seed in PATHS:
        work, throughput = np.zeros((STEPS, 2)), np.zeros((STEPS, 2))
        lead(closed_path(seed), row, work, throughput)
        assert (work >= -2000 * 2.3e-16 * throughput).all(), seed
        moved += throughput[-1].sum()
    assert moved > 1.0


@given(height=st.floats(-0.02, 0.01), v=st.tuples(speeds, speeds, speeds), shear=shears)
def test_no_state_dissipates_less_than_nothing(height, v, shear):
    """
    L10, L11: -F v - k_t z z' = c_t z'^2 + mu N |v_s| >= 0, v_s = v - z' is the slip.

    Whatever the normal force does: the energy k_t z^2/2 of the sole does not contain it.
    """
    f_x, f_y, normal, rate_x, rate_y = ground.contact(height, *v, *shear, ROW)
    taken = -(f_x * v[0] + f_y * v[1])
    stored = 1e5 * (shear[0] * rate_x + shear[1] * rate_y)
    lost = (15.0 * (rate_x * rate_x + rate_y * rate_y)
            + 0.7 * normal * math.hypot(v[0] - rate_x, v[1] - rate_y))
    # Rates are rounded in the sums they come from, below 1500 N, times at most 100 m/s.
    assert taken - stored == pytest.approx(lost, rel=1e-12, abs=1e-10)
