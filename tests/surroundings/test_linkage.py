"""Linkages: the published geometry's table, analytic derivatives, jit == Python."""

import math

from hypothesis import given, strategies as st
from isa_ros.surroundings import linkage
from isa_ros.surroundings.linkage_sheet import is_short, SHORTEST_LEVER
import numpy as np
import pytest

# HyQ-REAL knee: joint angle (deg), cylinder extension and lever (mm), each rounded to 0.1 mm.
KNEE = [
    (-38.4, 65.6, 24.9), (-60.0, 55.4, 29.4), (-80.0, 44.5, 32.7), (-100.0, 32.7, 34.6),
    (-110.0, 26.6, 34.7), (-120.0, 20.6, 34.1), (-140.0, 9.2, 30.6), (-158.7, 0.1, 24.6)]
# HyQ knee, same columns without the extension.
HYQ_KNEE = [(20.0, 22.5), (60.0, 41.3), (80.0, 44.9), (120.0, 35.6), (140.0, 22.5)]
ROUNDING = 0.05 + 1e-9  # mm


def record(kind, **fields):
    """Return one `LINKAGE` row."""
    row = np.zeros(1, linkage.LINKAGE).view(np.recarray)
    row['kind'] = kind
    row['sense'] = 1.0
    for name, value in fields.items():
        row[name] = value
    return row[0]


def knee():
    """Return the HyQ-REAL knee with its extension as coordinate."""
    return record(
        linkage.FOUR_BAR, offset=math.pi + 0.6, retracted_length=0.3131, bk=0.03, ar=0.07,
        br=0.07, ak_x=0.04 * math.cos(0.5), ak_y=-0.04 * math.sin(0.5), c_x=0.4, c_y=0.035)


LINKAGES = {
    'direct': (record(linkage.DIRECT, offset=math.radians(59.5)), -42.0, 23.0),
    'thigh': (record(linkage.SLIDER_CRANK, a=0.356, b=0.045, offset=math.radians(20.0),
                     retracted_length=0.299), 15.0, 125.0),
    'knee': (knee(), -158.7, -38.4),
    'hyq_thigh': (record(linkage.SLIDER_CRANK, a=0.3219, b=0.045, retracted_length=0.281,
                         offset=math.pi / 2 + 0.1089), -50.0, 70.0),
    'hyq_knee': (record(linkage.SLIDER_CRANK, a=0.3218, b=0.045, retracted_length=0.281,
                        offset=math.pi - 0.1403 - 0.1047), -140.0, -20.0),
}


@pytest.mark.parametrize(('angle', 'extension', 'lever'), KNEE)
def test_knee_four_bar_meets_the_published_table(angle, extension, lever):
    """L5: both columns to the table's last digit."""
    x, r, _ = linkage.actuator_coordinate(math.radians(angle), knee())
    assert abs(1e3 * x - extension) <= ROUNDING
    assert abs(1e3 * r - lever) <= ROUNDING


@pytest.mark.parametrize(('flexion', 'lever'), HYQ_KNEE)
def test_hyq_knee_slider_crank_meets_the_published_levers(flexion, lever):
    """L4: HyQ's knee, whose angle is minus the flexion."""
    _, r, _ = linkage.actuator_coordinate(math.radians(-flexion), LINKAGES['hyq_knee'][0])
    assert abs(1e3 * r - lever) <= ROUNDING


def test_thigh_uses_the_stroke_and_torque_stated_for_it():
    """L4: piston 21-95 mm, levers 23-45 mm, 175-338 Nm extending at 7515 N."""
    row, low, high = LINKAGES['thigh']
    angles = np.radians(np.linspace(low, high, 1101))
    x, r, _ = np.array([linkage.actuator_coordinate(q, row) for q in angles]).T
    assert round(1e3 * x[0]) == 21 and round(1e3 * x[-1]) == 95
    assert round(1e3 * r.min()) == 23 and round(1e3 * r.max()) == 45
    assert round(7515.0 * r.min()) == 175 and round(7515.0 * r.max()) == 338


def test_abduction_is_centred_in_the_rotary_manifold():
    """L3: -42..23 deg lies 17.5 deg from both ends of the vane's 100 deg."""
    row, low, high = LINKAGES['direct']
    ends = [math.degrees(linkage.actuator_coordinate(math.radians(q), row)[0])
            for q in (low, high)]
    assert ends[0] == pytest.approx(100.0 - ends[1], abs=1e-12)


@pytest.mark.parametrize('sense', [1.0, -1.0])
@given(share=st.floats(0.01, 0.99))
@pytest.mark.parametrize('name', list(LINKAGES))
def test_lever_and_its_derivative_equal_finite_differences(name, sense, share):
    """
    L2: r = dx/dq and dr/dq, central differences of x and of r over 2 e = 2e-5 rad.

    Bounds: truncation e^2/6 |x'''| < 1e-11 (1e-12 of x'''' on r) with derivatives of x below
    0.5 m; rounding of x < 0.5 (1.1e-16 in the lengths) over 2 e: 1e-11. Hence 1e-9.
    """
    row, low, high = LINKAGES[name]
    row = row.copy()
    row['sense'] = sense
    q = sense * math.radians(low + share * (high - low))
    e = 1e-5
    before, (_, r, dr), after = (
        linkage.actuator_coordinate(q + d, row) for d in (-e, 0.0, e))
    assert abs((after[0] - before[0]) / (2.0 * e) - r) < 1e-9
    assert abs((after[1] - before[1]) / (2.0 * e) - dr) < 1e-9


@pytest.mark.parametrize('name', list(LINKAGES))
@given(share=st.floats(0.0, 1.0))
def test_compiled_kernel_equals_its_python_source(name, share):
    """Replay depends on it: the jit must not reorder a rounding."""
    row, low, high = LINKAGES[name]
    q = math.radians(low + share * (high - low))
    kernel = {linkage.DIRECT: linkage.direct, linkage.SLIDER_CRANK: linkage.slider_crank,
              linkage.FOUR_BAR: linkage.four_bar}[int(row['kind'])]
    assert kernel(q, row) == kernel.py_func(q, row)
    assert kernel(q, row) == linkage.actuator_coordinate(q, row)


def test_a_lever_is_short_by_its_own_length_however_long_another_one_is():
    """It was compared by the product of both: 0.1 mm passed where the first lever is 40 mm."""
    assert not is_short(SHORTEST_LEVER, 40e-3) and not is_short(-SHORTEST_LEVER, -40e-3)
    for lever, first in ((1.9e-3, 40e-3), (-40e-3, 40e-3), (1e-4, 40e-3), (0.0, 40e-3)):
        assert is_short(lever, first)
        assert is_short(-lever, -first)


@pytest.mark.parametrize('name', LINKAGES)
def test_coordinates_and_levers_are_those_of_each_angle(name):
    """L2, at all angles in one call."""
    row = LINKAGES[name][0]
    angles = [-1.2, -0.7, 0.4]
    expected = np.array([linkage.actuator_coordinate(q, row)[:2] for q in angles]).T
    assert np.array_equal(linkage.motion(angles, row), expected, equal_nan=True)
    assert np.array_equal(linkage.levers(angles, row), expected[1], equal_nan=True)
    assert linkage.levers([], row) == []
