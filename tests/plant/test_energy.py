"""Powers and stored energies of one instant  (E1 to E6)."""

import math

from hypothesis import given, strategies as st
from isa_ros.plant.energy import elastic_energy, log_cosh, no_powers
from isa_ros.plant.mechanics import play
from isa_ros.plant.plant import PLANT_STATE
from isa_ros.plant.rates import plant_rates
from isa_ros.plant.servo_valve import (
    conductances, land_losses, port_flows, root_drops, tare_flow)
import numpy as np
import pytest
from scipy.integrate import quad
from tests.sheets import actuator_sheet, MODELS, override, plant_row

SUPPLY, BACK = 20.7e6, 0.5e6
PRESSURE = st.floats(-0.1e6, 24e6)
LOSSES = ('leakage', 'throttling', 'cross_port', 'relief')


@pytest.mark.parametrize('x', [0.0, 1e-9, 1.0, -1.0, 30.0, -700.0, 1e6])
def test_log_cosh_is_that_of_the_definition(x):
    expected = math.log(math.cosh(x)) if abs(x) < 100.0 else abs(x) - math.log(2.0)
    assert log_cosh(x) == pytest.approx(expected, rel=1e-14, abs=3e-16)


@pytest.mark.parametrize('backlash', [0.0, 1e-5, 1e-3])
def test_the_stretched_sensor_holds_the_integral_of_its_force(backlash):
    """E6: the spring of M1 from 0 to a stretch of 0.4 mm; nothing moves."""
    sheet = override(actuator_sheet('isa_v5'), 'plant.mechanics.backlash', backlash)
    mechanics = plant_row('isa_v5').mechanics
    mechanics.backlash = sheet.plant.mechanics.backlash
    held, _ = quad(lambda d: mechanics.k_s * play(d, backlash), 0.0, 4e-4, epsrel=1e-12)
    found = elastic_energy(0.0504, 0.0, 0.05, mechanics)
    assert found == pytest.approx(held, rel=1e-9, abs=0.0)
    moving = elastic_energy(0.0504, 0.3, 0.05, mechanics) - found
    assert moving == pytest.approx(0.5 * mechanics.inertia * 0.09, rel=1e-9, abs=0.0)


def valve_losses(x, p_a, p_b, back, valve):
    """Return the powers lost to leakage, that of the pilot stage included, and to throttling."""
    opened, leaks = conductances(x, valve)
    roots = root_drops(opened, p_a, p_b, SUPPLY, back, 0.0, 0.0, valve)
    leakage, throttling = land_losses(opened, leaks, roots, p_a, p_b, SUPPLY, back)
    return leakage + tare_flow(SUPPLY, back, valve) * (SUPPLY - back), throttling


@given(model=st.sampled_from(MODELS), x=st.floats(-1e-4, 1e-4), p_a=PRESSURE, p_b=PRESSURE)
def test_what_the_lands_lose_is_what_the_ports_do_not_get(model, x, p_a, p_b):
    """E2: P_S Q_P - P_T Q_T - P_A Q_A - P_B Q_B, whatever the directions of the flows."""
    valve = plant_row(model).valve
    q_a, q_b, q_p, q_t = port_flows(x, p_a, p_b, SUPPLY, BACK, valve)
    leakage, throttling = valve_losses(x, p_a, p_b, BACK, valve)
    lost = SUPPLY * q_p - BACK * q_t - p_a * q_a - p_b * q_b
    assert leakage > 0.0 and throttling >= 0.0
    assert leakage + throttling == pytest.approx(lost, rel=1e-9, abs=1e-6)


def test_a_closed_valve_only_leaks():
    """E2: at null no land is open, and all that the supply gives is leakage."""
    valve = plant_row('isa_v5').valve
    q_p = port_flows(0.0, 10e6, 10e6, SUPPLY, 0.0, valve)[2]
    leakage, throttling = valve_losses(0.0, 10e6, 10e6, 0.0, valve)
    q_a, q_b = port_flows(0.0, 10e6, 10e6, SUPPLY, 0.0, valve)[:2]
    assert throttling == 0.0
    assert leakage == pytest.approx(SUPPLY * q_p - 10e6 * (q_a + q_b), rel=1e-12, abs=0.0)


@given(model=st.sampled_from(MODELS), x=st.floats(-1e-4, 1e-4), p_a=PRESSURE, p_b=PRESSURE,
       v=st.floats(-1.0, 1.0), v_load=st.floats(-1.0, 1.0), place=st.floats(-1e-4, 1.01),
       stretch=st.floats(-1e-4, 1e-4), z=st.floats(-1e-5, 1e-5))
def test_the_balance_of_one_instant_closes(model, x, p_a, p_b, v, v_load, place, stretch, z):
    """
    E1 = E2 + E3 + E4 + E5 + dE6/dt for any state, by the rates themselves.

    The kinetic power is I s' s'', that of the sensor's spring its force times its rate; both
    do not come from `plant_rates`.
    """
    plant = plant_row(model)
    y, rates = np.zeros(2, PLANT_STATE).view(np.recarray)
    powers = no_powers()
    y.spool.position, y.chambers.p_a, y.chambers.p_b = x, p_a, p_b
    y.mechanics.position = s = place * plant.chambers.stroke
    y.mechanics.velocity, y.friction.bristle = v, z
    _, q_p, q_t = plant_rates(y, s - stretch, v_load, 0.0, SUPPLY, BACK, plant, False, rates, True,
                              powers)
    own = plant.mechanics
    spring = own.k_s * play(stretch, own.backlash) * (v - v_load)
    total = (sum(powers[name] for name in powers.dtype.names) + spring
             + own.inertia * v * rates.mechanics.velocity)
    size = sum(abs(powers[name]) for name in powers.dtype.names) + abs(spring)
    assert total == pytest.approx(SUPPLY * q_p - BACK * q_t, abs=1e-11 * size + 1e-9)
    assert min(powers[name] for name in LOSSES) >= 0.0
