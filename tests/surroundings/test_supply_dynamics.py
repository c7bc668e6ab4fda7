"""
The pump and its accumulator over time, against the exact solution of C8.

Below precharge the capacitance is the line's alone and C8 is linear as long as the pump is
within its band and the relief valve shut: C p' = Q - q, T Q' = q_max (p_set - p)/b - Q. Under
a constant flow q its solution is a matrix exponential.
"""

from isa_ros.core.units import LPM, MPA
from isa_ros.surroundings import supply
import numpy as np
import pytest
from scipy.linalg import expm

MS = 1_000_000
SHEET = supply.AccumulatorSupply(
    pressure_mpa=20.0, return_pressure_mpa=0.0, gas_volume_l=0.3, precharge_mpa=30.0,
    polytropic_exponent=1.3, line_volume_l=2.0, bulk_modulus=1e9, pump_flow_lpm=12.0,
    pump_lag_s=0.03, pump_band_mpa=2.0, relief_mpa=25.0, relief_lpm_per_mpa=10.0)
DRAWN = 3.0 * LPM
LINE = 2.0e-3 / 1e9  # m3/Pa


def exact(seconds: float) -> float:
    """Return the pressure after a constant flow `DRAWN`, from rest at the set point."""
    rate = 12.0 * LPM / (2.0 * MPA)
    # of p - p_set, Q and the constant 1
    matrix = np.array([[0.0, 1.0 / LINE, -DRAWN / LINE],
                       [-rate / 0.03, -1.0 / 0.03, 0.0],
                       [0.0, 0.0, 0.0]])
    return float(20.0 * MPA + (expm(matrix * seconds) @ [0.0, 0.0, 1.0])[0])


@pytest.mark.parametrize('step_ns', [MS // 10, MS // 2, MS, 2 * MS, 10 * MS])
def test_the_supply_keeps_the_time_of_its_ticks(step_ns):
    """
    C8 after 5, 20 and 60 ms, in ticks of any length.

    The mode is at 41 rad/s: a Runge-Kutta step of 0.1 ms errs by (w h)^5/120 = 1e-14 of a swing
    of 2 MPa, 600 of them by 1e-5 Pa. A step of 0.1 ms too few in each tick is 1 % and more.
    """
    plant = supply.Supply(SHEET, step_ns, flow_slope=1e-13)
    reached, expected = [], []
    for tick in range(1, 60 * MS // step_ns + 1):
        plant.advance(DRAWN * step_ns * 1e-9)
        if tick * step_ns in (20 * MS, 60 * MS):
            reached.append(plant.pressure)
            expected.append(exact(tick * step_ns * 1e-9))
    assert reached == pytest.approx(expected, rel=0.0, abs=1e-3)
    assert min(expected) > 18.0 * MPA and max(expected) < 20.0 * MPA, 'within the band'
    assert expected[0] < 20.0 * MPA - 1e5, 'and far from where it was'


def test_a_restored_supply_goes_on_where_it_was():
    """`state` includes the pump's flow."""
    plant, twin = (supply.Supply(SHEET, MS, flow_slope=1e-13) for _ in range(2))
    for _ in range(20):
        plant.advance(DRAWN * 1e-3)
    twin.state[:] = plant.state
    for _ in range(20):
        plant.advance(DRAWN * 1e-3)
        twin.advance(DRAWN * 1e-3)
    assert twin.state == plant.state
