"""Quantities that values scale with: what they say holds for the equations of the plant."""

from dataclasses import replace

from isa_ros.actuator.scales import SCALES
from isa_ros.actuator.sheet import ActuatorSheet, force_stiffness
from isa_ros.plant import chambers, servo_valve
from isa_ros.plant.plant import plant_record
from isa_ros.reu.schedule import POINTS
import numpy as np
import pytest
from tests.sheets import actuator_sheet

SUPPLY = 20.7e6
HALF = 0.5 * SUPPLY
SMALL = 1e-3  # of the full current: the flow's slope about null


def cylinder(rod_mm: float) -> ActuatorSheet:
    """Return the sheet of the model `cylinder` with another rod, without leakage at null."""
    sheet = actuator_sheet('cylinder')
    plant, leakage = sheet.plant, replace(
        sheet.plant.valve.leakage, current_ma=(0.0,), total_lpm=(0.4,))
    return replace(sheet, plant=replace(
        plant, drive=replace(plant.drive, rod_mm=rod_mm),
        valve=replace(plant.valve, leakage=leakage, orifice_smoothing_kpa=1e-3)))


@pytest.mark.parametrize('rod_mm', [12.0, 25.0, 34.0])
def test_the_force_gain_is_that_of_the_fastest_place(rod_mm):
    """
    C2, V7, M2: with it and the schedule the crossover is one over the lag, nowhere more.

    A thick rod makes the loop fastest at its extended end, a thin one at the retracted end.
    """
    sheet = cylinder(rod_mm)
    plant = plant_record(sheet.plant)[0]
    in_loop = force_stiffness(plant)
    gain, lag = (SCALES[name](sheet) for name in ('force_gain', 'valve_lag'))
    u = SMALL * 0.01
    q_a, q_b, _, _ = servo_valve.port_flows(
        u * plant.valve.k_spool, HALF, HALF, SUPPLY, 0.0, plant.valve)
    crossovers = []
    for place, stiffness in zip(np.linspace(0.0, plant.chambers.stroke, POINTS), in_loop):
        rates = chambers.pressure_rates(
            q_a, q_b, HALF, HALF, place, 0.0, plant.chambers)
        oil = chambers.oil_stiffness(place, plant.chambers)
        force_rate = chambers.hydraulic_force(*rates, plant.chambers) / (
            1.0 + oil / plant.mechanics.k_s)
        crossovers.append(gain * in_loop.min() / stiffness * force_rate / u)
    # a dozen roundings; the orifices' smoothing of 1 Pa on 10 MPa is 1e-14
    assert max(crossovers) == pytest.approx(1.0 / lag, rel=1e-9, abs=0.0)


def test_the_output_per_speed_gives_the_mean_of_the_flows():
    """V7: (A_A + A_B)/2 v at half the supply pressure over a land."""
    sheet = cylinder(25.0)
    plant = plant_record(sheet.plant)[0]
    u = SCALES['output_per_speed'](sheet) * 0.01  # for 10 mm/s
    q_a, q_b, _, _ = servo_valve.port_flows(
        u * plant.valve.k_spool, HALF, HALF, SUPPLY, 0.0, plant.valve)
    swept = 0.5 * (plant.chambers.area_a + plant.chambers.area_b) * 0.01
    assert (q_a, -q_b) == pytest.approx((swept, swept), rel=1e-9, abs=0.0)
