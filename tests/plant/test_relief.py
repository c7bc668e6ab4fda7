"""Relief and anti-cavitation valves."""

from isa_ros.core.units import LPM
from isa_ros.errors import ParameterError
from isa_ros.plant import relief
from isa_ros.plant.plant import plant_record
import pytest
from tests.sheets import actuator_sheet, override, plant_row

VALVE = plant_row('isa_v5').relief


def test_relief_opens_at_22_mpa_with_10_lpm_per_half_mpa():
    """C6, paper section 2.7."""
    assert relief.relief_flow(22.0e6, 0.0, VALVE) == 0.0
    assert relief.relief_flow(22.5e6, 0.0, VALVE) == pytest.approx(10.0 * LPM)


def test_refill_is_stated_at_a_tenth_of_a_megapascal_below_return():
    """C6: oil flows back in below the return pressure, none at it."""
    assert relief.relief_flow(0.3e6, 0.3e6, VALVE) == 0.0
    assert relief.relief_flow(0.2e6, 0.3e6, VALVE) == pytest.approx(-10.0 * LPM)


def test_a_relief_too_stiff_for_the_step_is_refused():
    """RK4 at 20 us is stable to a decay of 2.78/step: refused with value and bound."""
    sheet = override(actuator_sheet('isa_v5').plant, 'relief.slope_lpm_per_mpa', 40.0)
    with pytest.raises(ParameterError, match=r'slope_lpm_per_mpa = 40 .* must be <= 1.25e\+05'):
        plant_record(sheet)
