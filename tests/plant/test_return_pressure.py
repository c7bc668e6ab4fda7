"""
A return line under pressure: everything but the force counts from it.

Oil flows by pressure differences alone (V5 to V9, C2 and the refill of C6), so that all
pressures may be raised alike without changing a flow. Its modulus and its vapour pressure are
those of the oil: they do not follow the return (C5). The pressures here are whole pascals:
their sums and differences are exact, and so is the comparison.
"""

from hypothesis import given, strategies as st
from isa_ros.core.record import rows_of
from isa_ros.plant import relief, servo_valve
from isa_ros.plant.energy import no_powers
from isa_ros.plant.plant import PLANT_STATE
from isa_ros.plant.rates import plant_rates
import numpy as np
import pytest
from tests.sheets import MODELS, plant_row

SUPPLY, RETURN = 20_700_000, 1_500_000  # Pa
PLANTS = {model: plant_row(model) for model in MODELS}

spools = st.floats(-178e-6, 178e-6)
pressures = st.integers(0, 20_000_000)
below_atmosphere = st.integers(-90_000, 20_000_000)


@given(x=spools, p_a=below_atmosphere, p_b=below_atmosphere, raised=st.integers(0, 5_000_000))
def test_the_flows_of_a_valve_follow_pressure_differences_alone(x, p_a, p_b, raised):
    """V5, V7, V9: at return pressure as at none, of every land and of the pilot stage."""
    for plant in PLANTS.values():
        at_none = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0, plant.valve)
        assert servo_valve.port_flows(
            x, p_a + raised, p_b + raised, SUPPLY + raised, raised, plant.valve) == at_none


@pytest.mark.parametrize('model', MODELS)
def test_chambers_at_return_pressure_give_nothing_to_the_return(model):
    """V7, V9: only the tare flow is left, c sqrt(P_S - P_T); its smoothing is below 1e-5."""
    valve = PLANTS[model].valve
    _, _, _, q_t = servo_valve.port_flows(1e-4, RETURN, RETURN, SUPPLY, RETURN, valve)
    assert q_t == pytest.approx(valve.c_tare * (SUPPLY - RETURN) ** 0.5, rel=1e-5, abs=0.0)


@given(below=st.integers(0, 90_000), p_t=st.integers(0, 5_000_000))
def test_the_refill_follows_the_drop_below_the_return(below, p_t):
    """C6: c (P_T - P)^2 whatever the return pressure is."""
    for plant in PLANTS.values():
        assert relief.relief_flow(p_t - below, p_t, plant.relief) == (
            relief.relief_flow(-below, 0, plant.relief))


def plant_flows(
        plant: np.record, spool: float, p_a: int, p_b: int, raised: int) -> tuple[float, ...]:
    """Return both pressures' rates, q_p and q_t of a resting plant, all raised alike."""
    y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
    y.mechanics.position = x = 0.4 * plant.chambers.stroke
    y.spool.position = spool
    y.chambers.p_a, y.chambers.p_b = p_a + raised, p_b + raised
    _, q_p, q_t = plant_rates(
        y, x, 0.0, 0.0, SUPPLY + raised, raised, plant, False, rates, False, no_powers())
    return rates.chambers.p_a, rates.chambers.p_b, q_p, q_t


@given(x=spools, p_a=pressures, p_b=pressures, raised=st.integers(0, 1_900_000))
def test_a_plant_hands_the_return_pressure_to_all_its_parts(x, p_a, p_b, raised):
    """C2 with V9 and C6: below the relief's 22 MPa."""
    for plant in PLANTS.values():
        assert plant_flows(plant, x, p_a, p_b, raised) == plant_flows(plant, x, p_a, p_b, 0)


def test_the_null_bias_of_a_plant_shifts_with_the_return_pressure():
    """V12: b_T P_T drives the spool: w_n^2 K_loop K_spool b_T P_T of equation 8."""
    plant = PLANTS['smart_manifold']
    jerks = []
    for p_t in (0.0, 3.5e6):
        y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
        plant_rates(y, 0.0, 0.0, 0.0, SUPPLY, p_t, plant, False, rates, False, no_powers())
        jerks.append(rates.spool.acceleration)
    w_n = plant.spool.w_n
    reference = plant.valve.k_spool * plant.spool.bias_t * 3.5e6
    assert jerks[1] - jerks[0] == pytest.approx(
        w_n * w_n * plant.spool.k_loop * reference, rel=1e-12, abs=0.0)
