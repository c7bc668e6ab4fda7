"""The current block: equations 1 and 2, and the sampled loop around the explicit coil."""

import cmath
from dataclasses import replace
import math

from isa_ros.core.record import rows_of
from isa_ros.errors import ParameterError
from isa_ros.reu import lead_lag
import numpy as np
import pytest
from tests.sheets import actuator_sheet

SHEET = actuator_sheet('smart_manifold', 'table_4', 'explicit').reu.current
LOOP = lead_lag.lead_lag_record(SHEET)
PERIOD = 1.0 / SHEET.rate_hz


def continuous(s: complex) -> complex:
    """Return C(s) of equation 1 in V/A."""
    lead, lag = SHEET.lead_rad_per_s, SHEET.lag_rad_per_s
    return (SHEET.kp_v_per_ma * 1e3 * lag ** 2 / lead ** 2
            * (s * s + 2.0 * SHEET.lead_damping * lead * s + lead ** 2)
            / (s * s + 2.0 * SHEET.lag_damping * lag * s + lag ** 2))


def test_demand_gain_is_equation_2():
    """R10: 16 V/mA and 10 mA at 24 V give the printed 1.15 (errata 7)."""
    assert lead_lag.demand_gain(16e3, 10e-3 / 24.0) == pytest.approx(1.15, abs=5e-4)
    assert SHEET.kpf == 1.15


@pytest.mark.parametrize('hz', [10.0, 500.0, 1700.0, 3000.0])
def test_filter_is_equation_1_by_tustin(hz):
    """R9: C(z) on the unit circle is C(s) at s = c tanh(j w T/2), from the running filter."""
    state = rows_of(1, lead_lag.LEAD_LAG_STATE)[0]
    w = 2.0 * math.pi * hz * PERIOD
    n = 4000
    # far below saturation: 1 uA times 16 V/mA
    u = np.array([lead_lag.lead_lag_step(0.0, -1e-6 * math.cos(w * k), LOOP, state)
                  for k in range(n)])
    k = np.arange(n // 2, n)
    basis = np.stack([np.cos(w * k), -np.sin(w * k)], axis=1)
    (real, imag), *_ = np.linalg.lstsq(basis, u[n // 2:], rcond=None)
    lead = SHEET.lead_rad_per_s
    warped = lead / math.tan(0.5 * lead * PERIOD)
    expected = continuous(warped * cmath.tanh(0.5j * w))
    assert complex(real, imag) / 1e-6 == pytest.approx(expected, rel=1e-6)


def test_notch_is_at_its_frequency():
    """R9: the numerator's zeros are at 1700 Hz, w_lead of Table 4, not at 1548 Hz."""
    zero = np.roots([LOOP.b_0, LOOP.b_1, LOOP.b_2])[0]
    found = abs(np.log(zero)) / PERIOD
    assert found == pytest.approx(SHEET.lead_rad_per_s, rel=5e-3)
    weakest = min(range(1000, 2500), key=lambda hz: abs(
        np.polyval([LOOP.b_0, LOOP.b_1, LOOP.b_2], cmath.exp(2j * math.pi * hz * PERIOD))))
    assert weakest / (SHEET.lead_rad_per_s / (2.0 * math.pi)) == pytest.approx(1.0, abs=0.01)


def test_a_notch_beyond_half_the_loop_rate_is_refused():
    """Its sampled frequency does not exist."""
    with pytest.raises(ParameterError, match=r'lead_rad_per_s = 40000 rad/s, must be < 31415.9'):
        replace(SHEET, lead_rad_per_s=4e4)


def test_output_saturates_at_the_supply():
    """24 V, whatever the demand."""
    state = rows_of(1, lead_lag.LEAD_LAG_STATE)[0]
    assert lead_lag.lead_lag_step(1.0, 0.0, LOOP, state) == 24.0
    assert lead_lag.lead_lag_step(-1.0, 0.0, LOOP, state) == -24.0


def changed(**values: object) -> np.record:
    """Return the record with some values of the sheet replaced."""
    return lead_lag.lead_lag_record(replace(SHEET, **values))


def voltages(loop: np.record, reference: float, measured: float, n: int) -> list[float]:
    """Return the voltages of ``n`` periods from rest under constant currents (A)."""
    state = rows_of(1, lead_lag.LEAD_LAG_STATE)[0]
    return [lead_lag.lead_lag_step(reference, measured, loop, state) for _ in range(n)]


def test_integral_grows_with_the_error():
    """R9: K_i T e a period, on top of the shipped loop's voltage."""
    plain, integrating = LOOP, changed(ki_v_per_ma_s=100.0)
    error = 1e-6
    grown = np.subtract(voltages(integrating, error, 0.0, 5), voltages(plain, error, 0.0, 5))
    expected = 100.0 * 1e3 * PERIOD * error * np.arange(5)
    # one rounding of a voltage of 20 mV each
    assert grown == pytest.approx(expected, abs=1e-16)


def test_integral_stands_still_at_the_supply():
    """R5: saturated by the proportional part, the loop does not wind up."""
    def integral_after(loop: np.record) -> float:
        for _ in range(50):
            assert lead_lag.lead_lag_step(0.01, 0.0, loop, state) == 24.0
        return float(state.integral)
    state = rows_of(1, lead_lag.LEAD_LAG_STATE)[0]
    for _ in range(50):  # the lead-lag's own transient leaves saturation once
        lead_lag.lead_lag_step(0.01, 0.0, LOOP, state)
    assert integral_after(changed(ki_v_per_ma_s=100.0)) == 0.0
    free = changed(ki_v_per_ma_s=100.0, anti_windup='none')
    assert integral_after(free) == pytest.approx(50 * 1e5 * PERIOD * 0.01)


def test_offset_and_derivative_add_their_share():
    """R9: U_0 at once, K_d times the filtered slope of the first error."""
    plain = voltages(LOOP, 1e-6, 0.0, 1)[0]
    assert voltages(changed(offset_v=0.5), 1e-6, 0.0, 1)[0] - plain == pytest.approx(0.5)
    alpha = 1.0 - math.exp(-2.0 * math.pi * 2000.0 * PERIOD)
    kicked = voltages(changed(kd_v_s_per_ma=1e-3), 1e-6, 0.0, 1)[0] - plain
    assert kicked == pytest.approx(1.0 * alpha * 1e-6 / PERIOD)


def test_compiled_step_equals_its_python_source():
    """A few periods with every term, every state."""
    loop = changed(ki_v_per_ma_s=50.0, kd_v_s_per_ma=1e-4, offset_v=0.1)
    compiled, python = (
        rows_of(1, lead_lag.LEAD_LAG_STATE)[0] for _ in 'ab')
    for measured in (0.0, 1e-4, -3e-4, 2e-3):
        assert (lead_lag.lead_lag_step(1e-3, measured, loop, compiled)
                == lead_lag.lead_lag_step.py_func(1e-3, measured, loop, python))
    assert compiled.tobytes() == python.tobytes()
