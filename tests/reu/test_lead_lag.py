"""The current block: equations 1 and 2, and the sampled loop around the explicit coil."""

import cmath
import math

from isa_ros.reu import lead_lag
import numpy as np
import pytest
from tests.sheets import actuator_sheet

SHEET = actuator_sheet('smart_manifold', 'table_4', 'explicit').reu.current
LOOP = np.array([lead_lag.lead_lag_record(SHEET)], lead_lag.LEAD_LAG).view(np.recarray)[0]
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
    """R9: C(z) on the unit circle is C(s) at s = 2/T tanh(j w T/2), from the running filter."""
    state = np.zeros(1, lead_lag.LEAD_LAG_STATE).view(np.recarray)[0]
    w = 2.0 * math.pi * hz * PERIOD
    n = 4000
    # far below saturation: 1 uA times 16 V/mA
    u = np.array([lead_lag.lead_lag_step(0.0, -1e-6 * math.cos(w * k), LOOP, state)
                  for k in range(n)])
    k = np.arange(n // 2, n)
    basis = np.stack([np.cos(w * k), -np.sin(w * k)], axis=1)
    (real, imag), *_ = np.linalg.lstsq(basis, u[n // 2:], rcond=None)
    expected = continuous(2.0 / PERIOD * cmath.tanh(0.5j * w))
    assert complex(real, imag) / 1e-6 == pytest.approx(expected, rel=1e-6)


def test_output_saturates_at_the_supply():
    """24 V, whatever the demand."""
    state = np.zeros(1, lead_lag.LEAD_LAG_STATE).view(np.recarray)[0]
    assert lead_lag.lead_lag_step(1.0, 0.0, LOOP, state) == 24.0
    assert lead_lag.lead_lag_step(-1.0, 0.0, LOOP, state) == -24.0
