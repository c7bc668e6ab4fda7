"""The lag of a valve (R16); other ratings are tested where they are used."""

from isa_ros.actuator.ratings import valve_lag
import pytest
from tests.sheets import actuator_sheet, plant_record


def test_the_lag_of_a_valve_is_the_sum_of_its_periods_and_lags():
    """R16, ISA v5: 10 kHz, 5 kHz, p_c of V1 and K_loop of V3."""
    sheet = actuator_sheet('isa_v5')
    # a dozen roundings
    assert valve_lag(plant_record(sheet.plant)[0], sheet.reu) == pytest.approx(
        1e-4 + 2e-4 + 1 / 2000.0 + 1 / 540.0, rel=1e-14, abs=0.0)
