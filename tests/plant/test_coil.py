"""The coil: voltage limit, redundant coils, the explicit coil's gain and resonance."""

import math

from hypothesis import given, strategies as st
from isa_ros.core.record import row_record
from isa_ros.plant import coil
from isa_ros.plant.plant import plant_record
import numpy as np
import pytest
from tests.sheets import actuator_sheet, override, plant_row

CLOSED = plant_row('smart_manifold').coil
EXPLICIT = plant_record(actuator_sheet('smart_manifold', 'table_4', 'explicit').plant)[0].coil


def coil_state(*values: float) -> np.record:
    """Return a `COIL_STATE` row."""
    return row_record(np.array([values or (0.0, 0.0, 0.0)], coil.COIL_STATE))


def wired(coils: str) -> np.record:
    """Return the closed-loop coil's record with its coils wired otherwise."""
    sheet = override(actuator_sheet('smart_manifold'), 'plant.coil.coils', coils)
    return plant_record(sheet.plant)[0].coil


def test_amplifier_voltage_limits_a_large_current_step():
    """V1: 24 V over 9.2 H is 2.6 A/s at zero current, and zero at 10 mA."""
    assert coil.current_rate(0.0, 0.010, CLOSED) == pytest.approx(24.0 / 9.2)
    assert coil.current_rate(0.010, 0.020, CLOSED) == pytest.approx(0.0, abs=1e-9)
    assert coil.current_rate(0.0, 0.001, CLOSED) == pytest.approx(2.0)


def test_the_circuit_follows_the_wiring():
    """Two coils of 4800 ohm: 2400 in parallel, 9600 in series, 4800 with one broken."""
    for coils, resistance, per_series in (
            ('parallel', 2400.0, 2.0), ('series', 9600.0, 1.0), ('one_open', 4800.0, 2.0)):
        own = wired(coils)
        assert (own.resistance, own.parallel) == (resistance, per_series)


def test_one_open_coil_halves_what_the_amplifier_can_give():
    """At 24 V: 10 mA in parallel, 5 mA with one coil broken; on the series scale half of each."""
    for coils, largest in (('parallel', 10e-3), ('one_open', 5e-3)):
        own = wired(coils)
        assert coil.current_rate(largest, 1.0, own) == pytest.approx(0.0, abs=1e-9)
        assert own.parallel == 2.0


def response(hz: float) -> complex:
    """Return I/U of the explicit coil, differenced from its kernel, which is linear."""
    def rates(y: np.ndarray, voltage: float) -> np.ndarray:
        return np.array(coil.explicit_rates(coil_state(*y), voltage, EXPLICIT))
    matrix = np.array([rates(e, 0.0) for e in np.eye(3)]).T
    states = np.linalg.solve(2j * math.pi * hz * np.eye(3) - matrix, rates(np.zeros(3), 1.0))
    real, imag = (coil.coil_current(coil_state(*part), EXPLICIT)
                  for part in (states.real, states.imag))
    return complex(real, imag)


def test_static_gain_is_10_ma_at_24_v():
    """V11: the resonance is part of the coil's gain, not an addition to it (errata 7)."""
    assert abs(response(1e-3)) == pytest.approx(10e-3 / 24.0, rel=1e-5)


def test_the_coil_resonates_at_1_8_khz():
    """V11, Fig 8 B: k/(2 zeta) of the current at a right angle to the rest of it."""
    w = 2.0 * math.pi * 1800.0
    first_order = 1.0 / (EXPLICIT.resistance + 1j * w * EXPLICIT.inductance)
    k = 0.1
    # H(jw) of the resonance is 1/(2 j zeta)
    expected = first_order * (1.0 + k * (1.0 / (2j * 0.03) - 1.0))
    assert response(1800.0) == pytest.approx(expected, rel=1e-9, abs=0.0)


def test_the_resonance_heats_the_coil_too():
    """E8: R i^2 of i = i_1 + k (m - i_1), not of the first-order current i_1 alone."""
    k = EXPLICIT.mode_share
    assert k > 0.0
    for first, mode in ((2e-3, 2e-3), (2e-3, -5e-3), (0.0, 4e-3)):
        current = first + k * (mode - first)
        assert coil.coil_heat(coil_state(first, mode, 0.0), EXPLICIT) == pytest.approx(
            EXPLICIT.resistance * current * current, rel=1e-12, abs=0.0)
    assert coil.coil_heat(coil_state(2e-3, 9.0, 9.0), CLOSED) == CLOSED.resistance * 2e-3 * 2e-3


@given(current=st.floats(-1e-2, 1e-2), drive=st.floats(-30.0, 30.0))
def test_compiled_rates_equal_their_python_source(current, drive):
    """Both kinds of coil."""
    for own in (CLOSED, EXPLICIT):
        y, compiled, python = coil_state(current, 1e-4, 2.0), coil_state(), coil_state()
        coil.coil_rates(y, drive, own, compiled)
        coil.coil_rates.py_func(y, drive, own, python)
        assert compiled.tobytes() == python.tobytes()
