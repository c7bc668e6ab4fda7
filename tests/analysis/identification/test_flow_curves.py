"""Flow curves of identification are the plant's, and their derivatives are derivatives."""

from isa_ros.analysis.identification.flow_curves import DualGainCurve, FlowCurve, HighResponseCurve
from isa_ros.plant.servo_valve import flow_curve
import numpy as np
import pytest
from tests.sheets import plant_row

OPENINGS = np.linspace(-2e-5, 1.7e-4, 39)


def shipped(model: str) -> tuple[FlowCurve, np.ndarray]:
    valve = plant_row(model).valve
    if valve.q_rest > 0.0:
        return HighResponseCurve(valve.x_dg), np.array([valve.k_low, valve.q_rest])
    return DualGainCurve(valve.x_dg), np.array([valve.k_low, valve.k_high, valve.x_dg])


@pytest.mark.parametrize('model', ['smart_manifold', 'isa_v5', 'isa_v2'])
def test_the_curve_is_the_plants(model: str) -> None:
    """V4, to rounding; a closed land has no flow."""
    valve = plant_row(model).valve
    curve, theta = shipped(model)
    expected = [flow_curve(u, valve) if u > 0.0 else 0.0 for u in OPENINGS]
    assert curve.flow(OPENINGS, theta) == pytest.approx(expected, rel=1e-12, abs=1e-18)


@pytest.mark.parametrize('model', ['isa_v5', 'isa_v2'])
def test_derivatives_are_those_of_the_flow(model: str) -> None:
    """Central differences over 1e-6 of each; 1e-9 of the flow is their rounding over that."""
    curve, theta = shipped(model)
    scale = np.max(curve.flow(OPENINGS, theta))
    for k in range(curve.size):
        step = np.zeros(curve.size)
        step[k] = 1e-6 * theta[k]
        difference = curve.flow(OPENINGS, theta + step) - curve.flow(OPENINGS, theta - step)
        assert 2.0 * step[k] * curve.derivative(OPENINGS, theta, k) == pytest.approx(
            difference, abs=1e-9 * scale)
    away = OPENINGS[np.abs(OPENINGS) > 1e-6]  # from the kink at null
    h = 1e-10
    difference = curve.flow(away + h, theta) - curve.flow(away - h, theta)
    assert 2.0 * h * curve.slope(away, theta) == pytest.approx(difference, abs=1e-9 * scale)


def test_a_spool_about_null_excites_the_low_gain_only() -> None:
    curve, _ = shipped('isa_v5')
    assert curve.excited(np.linspace(0.0, 4e-5, 500)) == [0]
    assert curve.excited(np.linspace(0.0, 6e-5, 500)) == [0, 1, 2]
