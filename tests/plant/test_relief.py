"""Relief and anti-cavitation valves."""

from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import LPM
from isa_ros.plant import relief
import pytest
from tests.sheets import plant_row

VALVE = plant_row('isa_v5').relief


def test_relief_opens_at_22_mpa_with_10_lpm_per_half_mpa():
    """C6, paper section 2.7."""
    assert relief.relief_flow(22.0e6, 0.0, VALVE) == 0.0
    assert relief.relief_flow(22.5e6, 0.0, VALVE) == pytest.approx(10.0 * LPM)


def test_refill_is_stated_at_a_tenth_of_a_megapascal_below_return():
    """C6: oil flows back in below the return pressure, none at it."""
    assert relief.relief_flow(0.3e6, 0.3e6, VALVE) == 0.0
    assert relief.relief_flow(0.2e6, 0.3e6, VALVE) == pytest.approx(-10.0 * LPM)


ELASTANCES = (1e13, 3.5e14, 1e15, 2e15)
"""Of a chamber, Pa/m3: half full, at its end, there with oil of 2 GPa, on 1 ml."""


@pytest.mark.parametrize('elastance', ELASTANCES)
@pytest.mark.parametrize(('surplus', 'start'), [(10.0 * LPM, 22.0e6), (-10.0 * LPM, -1e3)])
def test_a_chamber_settles_where_the_valve_takes_what_comes(elastance, surplus, start):
    """C10: with RK4 steps of 20 us at any elastance; C6 gives the pressure at rest."""
    def rate(p: float) -> float:
        return elastance * (surplus - relief.eased_flow(p, 0.0, surplus, elastance, VALVE))
    p, h = start, PLANT_STEP
    for _ in range(20000):
        a = rate(p)
        b = rate(p + 0.5 * h * a)
        c = rate(p + 0.5 * h * b)
        p += h / 6.0 * (a + 2.0 * (b + c) + rate(p + h * c))
    flow = relief.eased_flow(p, 0.0, surplus, elastance, VALVE)
    assert flow == pytest.approx(surplus, rel=1e-9, abs=0.0)
    assert relief.relief_flow(p, 0.0, VALVE) == pytest.approx(surplus, rel=1e-9, abs=0.0)


def test_slow_valves_are_those_of_c6_to_the_bit():
    """C10 changes nothing where a step resolves the decay."""
    for p in (22.3e6, -5e4):
        assert relief.eased_flow(p, 0.0, 1e-5, 1e13, VALVE) == relief.relief_flow(p, 0.0, VALVE)


@pytest.mark.parametrize('p', [22.1e6, -4e4])
def test_no_valve_flows_backwards(p):
    """C10: whatever else flows, a relief valve gives no oil and a check valve takes none."""
    for surplus in (-1e-3, 1e-3):
        flow = relief.eased_flow(p, 0.0, surplus, 1e16, VALVE)
        assert flow >= 0.0 if p > 0.0 else flow <= 0.0
