"""The linear response of a control block, from its kernel."""

from dataclasses import replace

from isa_ros.analysis.tuning.block_response import parts, responses
from isa_ros.reu.block import Pid
import numpy as np
import pytest
from tests.sheets import actuator_sheet

FREQUENCY = np.geomspace(1.0, 1000.0, 30)


def force_block(model: str, **values: float | str) -> Pid:
    """Return a force block with other values."""
    block = actuator_sheet(model).reu.force
    assert isinstance(block, Pid)
    return replace(block, **values)


def test_a_proportional_block_is_its_gain():
    """U = K_p (b R - Y): a compensation and a limit are not part of it."""
    block = force_block('isa_v5', kp=3e-8, ki=0.0, kf=0.0, setpoint_weight=0.7, limit=1e-9)
    of_reference, of_measured = responses(block, FREQUENCY)
    # a sum of zeros and one term
    assert of_reference == pytest.approx(np.full(30, 0.7 * 3e-8), rel=1e-12, abs=0.0)
    assert of_measured == pytest.approx(np.full(30, 3e-8), rel=1e-12, abs=0.0)


def test_an_integral_is_the_sum_of_the_errors_before():
    """I[k] = K_i T (e[0] + ... + e[k - 1]): K_i T z^-1 / (1 - z^-1)."""
    of_reference, of_measured = responses(
        force_block('isa_v5', kp=0.0, ki=2e-6, kf=0.0), FREQUENCY)
    late = np.exp(-2j * np.pi * FREQUENCY / 5000.0)
    # 400 terms are added: 400 * 2.2e-16 of their sum
    assert of_reference == pytest.approx(2e-6 / 5000.0 * late / (1.0 - late), rel=1e-10, abs=0.0)
    assert of_measured == pytest.approx(of_reference, rel=1e-10, abs=0.0)


def test_damping_adds_lead_to_the_measured_value_alone():
    """K_f y' behind a low-pass: a phase lead far below its 500 Hz, none on the reference."""
    plain = responses(force_block('isa_v5', ki=0.0, kf=0.0), FREQUENCY)
    damped = responses(force_block('isa_v5', ki=0.0, kf=2e-3), FREQUENCY)
    assert damped[0] == pytest.approx(plain[0], rel=1e-12, abs=0.0)
    lead = damped[1][:10] / plain[1][:10]
    expected = 1.0 + 2e-3 * 2j * np.pi * FREQUENCY[:10]
    # The low-pass and half a sample: 2 pi 8.6 Hz (0.32 ms + 0.1 ms) = 0.023 of the added part,
    # 0.11 at 8.6 Hz
    assert lead == pytest.approx(expected, abs=0.023 * 0.11)


@pytest.mark.parametrize('model', ['isa_v5', 'isa_v2', 'smart_manifold'])
@pytest.mark.parametrize('more', [
    {}, {'feedback_damping': 'proportional'},
    {'kd': 1e-11, 'kr': 2e-9, 'measured_filter_hz': 300.0}])
def test_parts_put_together_are_the_block(model, more):
    """Any gains, any factor of the schedule: the search depends on it."""
    block = force_block(model, **more)
    for kp, ki, kf, factor in ((8e-8, 3e-6, 2e-3, 1.0), (2e-7, 1e-5, 7e-4, 0.3)):
        expected = responses(replace(block, kp=kp, ki=ki, kf=kf), FREQUENCY, factor)
        for part, response in zip(parts(block, FREQUENCY), expected):
            got = part.at(factor * kp, factor * ki, kf)
            # The parts are differences of sums of 400 terms, K_f's divided by 1e-3.
            assert got == pytest.approx(response, rel=1e-9, abs=1e-9 * np.abs(response).max())
