"""The lag of a valve (R16), losses of a motor (R17); others are tested where they are used."""

import math

from isa_ros.actuator.ratings import valve_lag
from isa_ros.actuator.sheet import actuator_record
import pytest
from tests.sheets import actuator_sheet, plant_record


def test_the_lag_of_a_valve_is_the_sum_of_its_periods_and_lags():
    """R16, ISA v5: 10 kHz, 5 kHz, p_c of V1 and K_loop of V3."""
    sheet = actuator_sheet('isa_v5')
    # a dozen roundings
    assert valve_lag(plant_record(sheet.plant)[0], sheet.reu) == pytest.approx(
        1e-4 + 2e-4 + 1 / 2000.0 + 1 / 540.0, rel=1e-14, abs=0.0)


def test_the_supervision_of_a_motor_knows_its_losses_and_that_of_a_cylinder_none():
    """R17, M8: 8 and 12 % of D dp at 100 and 1500 rpm, and the Coulomb friction beside them."""
    sheet = actuator_sheet('hydraulic_motor')
    own = actuator_record(sheet, 0)[0]['reu']['protection']['supervision']
    torques = [15.9e-6 * 20e6 * lost for lost in (0.08, 0.12)]
    viscous = (torques[1] - torques[0]) / (1400.0 * math.pi / 30.0)
    coulomb = torques[0] - viscous * 100.0 * math.pi / 30.0 + sheet.plant.friction.coulomb
    # differences of torques five times as small as they are: ten roundings
    assert own['coulomb'] == pytest.approx(coulomb, rel=1e-13, abs=0.0)
    assert own['viscous'] == pytest.approx(viscous, rel=1e-13, abs=0.0)
    other = actuator_record(actuator_sheet('isa_v5'), 0)[0]['reu']['protection']['supervision']
    assert (other['coulomb'], other['viscous']) == (0.0, 0.0)
