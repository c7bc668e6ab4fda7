"""Heat of a circuit: walls and coolers, capacity, the oil at a temperature, what is refused."""

import math

from isa_ros.core.record import rows_of
from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits.heat import (
    coldest, heat_capacity, MixedHeat, OIL_STATE, warm_oil)
from isa_ros.surroundings.circuits.line import lump_fields
from isa_ros.surroundings.circuits.oil import oil_at_sheet
from isa_ros.surroundings.circuits.plan import network_of
from isa_ros.surroundings.circuits.warmth import coldest_oil, warmth_of
import numpy as np
import pytest
from tests.surroundings.circuits.advanced import advance
from tests.surroundings.circuits.sheets import circuit_of, sheet_of, SIMPLE
from tests.surroundings.circuits.station import STATION

HEAT = 'heat: {kind: mixed, oil_volume_l: 0.5, metal_heat_capacity: 120.0, start_celsius: 31.0, ' \
    'air_celsius: 17.0, walls_w_per_k: 3.0, actuators_percent: 90.0, oil: {density: 860.0, ' \
    'specific_heat: 1970.0, viscosity_at_40_cst: 32.0, viscosity_at_100_cst: 5.4, ' \
    'compressibility_per_k: 4.5e-3}}'
COOLER = 'cooler: {kind: cooler, w_per_k: 40.0, coolant_celsius: 12.0}\n'
SAFETY = 'safety: {kind: relief, inlet: main, outlet: tank, opens_mpa: 18.0, lpm_per_mpa: 30.0}\n'
HOT = SIMPLE.replace('kind: tank}', f'kind: tank, {HEAT}}}').replace(
    'leakage', 'efficiency_percent: 85.0, leakage') + SAFETY + COOLER
HOT_STATION = STATION.replace('pressure_mpa: 0.2}', 'pressure_mpa: 0.2, ' + HEAT + '}').replace(
    'power_w', 'efficiency_percent: 80.0, power_w') + COOLER
CAPACITY = 860.0 * 1970.0 * 0.5e-3 + 120.0      # J/K


def walther(celsius: float) -> float:
    """Return nu of an ISO VG 32 by two points, mm2/s."""
    def ordinate(nu: float) -> float:
        return math.log(math.log(nu + 0.7))
    slope = (ordinate(32.0) - ordinate(5.4)) / math.log(373.15 / 313.15)
    return math.exp(math.exp(
        ordinate(32.0) - slope * math.log((celsius + 273.15) / 313.15))) - 0.7


def test_walls_and_coolers_find_the_balance() -> None:
    """At rest of all but a loss of 1 kW: theta = (P + sum(G theta_k))/sum(G)."""
    oil: np.record = rows_of(1, OIL_STATE)[0]
    oil.celsius = 31.0
    given, ways = np.zeros(2), np.array([(3.0, 17.0), (40.0, 12.0)])
    for _ in range(200):
        warm_oil(60.0, 60.0 * 1000.0, CAPACITY, ways, oil, given)
    assert float(oil.celsius) == pytest.approx((1000.0 + 3.0 * 17.0 + 40.0 * 12.0) / 43.0)
    # one step of hours is as exact as many short ones
    long: np.record = rows_of(1, OIL_STATE)[0]
    long.celsius, once = 31.0, np.zeros(2)
    warm_oil(12000.0, 12000.0 * 1000.0, CAPACITY, ways, long, once)
    assert float(long.celsius) == pytest.approx(float(oil.celsius), rel=1e-12)
    assert once == pytest.approx(given, rel=1e-9)
    assert once[0] == pytest.approx(3.0 * 12000.0 * (oil.celsius - 17.0), rel=0.01)


def test_without_a_way_all_heat_stays() -> None:
    """T7 with G = 0."""
    oil: np.record = rows_of(1, OIL_STATE)[0]
    oil.celsius, given = 20.0, np.zeros(1)
    warm_oil(5.0, 700.0, 350.0, np.array([(0.0, 17.0)]), oil, given)
    assert (float(oil.celsius), float(oil.got), given[0]) == (22.0, 700.0, 0.0)


def test_warm_oil_is_thinner_and_softer() -> None:
    """T9: of 31 celsius against the section's 40, by the equations of a data sheet."""
    sheet = sheet_of(HOT_STATION)
    cold, base = network_of(sheet, coldest_oil(sheet, warmth_of(sheet))), network_of(sheet)
    # the coolant of 12 celsius is the coldest that its oil can have
    thick, soft = walther(12.0) / 32.0, 1.0 - 28.0 * 4.5e-3
    node, line = base.node('gallery'), base.of('hose')[0]
    assert float(base.nodes[node]['c']) == pytest.approx(
        float(cold.nodes[node]['c']) / soft, rel=1e-12, abs=0.0)
    assert float(cold.elements[line]['line']['laminar']) == pytest.approx(
        float(base.elements[line]['line']['laminar']) * thick, rel=1e-9, abs=0.0)
    assert float(cold.elements[line]['line']['turbulent']) == pytest.approx(
        float(base.elements[line]['line']['turbulent']) * thick ** 0.25, rel=1e-9)
    pump = base.of('pump')[0]
    assert float(cold.elements[pump]['pump']['g']) == pytest.approx(
        float(base.elements[pump]['pump']['g']) / thick, rel=1e-9, abs=0.0)
    assert thick > 3.0


def test_the_oil_of_the_section_is_that_of_its_temperature() -> None:
    """No factor at all: what has no heat stays as it is, bit for bit."""
    sheet = sheet_of(STATION)
    oil = oil_at_sheet(sheet.oil)
    assert oil == (1.2e9, 860.0, 32.0, 1.0)
    assert coldest_oil(sheet, None) == oil
    hose = sheet.by_name['hose']
    assert lump_fields(hose, oil) == tuple(   # type: ignore[arg-type]
        network_of(sheet).elements[network_of(sheet).of('hose')[0]]['line'].tolist())


def test_nothing_colder_than_the_start_is_met_without_a_way() -> None:
    """Neither air nor coolant behind no conductance."""
    heat = sheet_of(HOT).heat
    assert isinstance(heat, MixedHeat)
    for ways, expected in (((0.0, -20.0), 31.0), ((2.0, -20.0), -20.0), ((2.0, 50.0), 31.0)):
        assert coldest(heat, np.array([ways])) == expected
    alone = SIMPLE.replace('kind: tank}', f'kind: tank, {HEAT}}}').replace(
        'walls_w_per_k: 3.0, ', '')
    own = sheet_of(alone)
    assert coldest_oil(own, warmth_of(own)).thickness == pytest.approx(walther(31.0) / 32.0)
    circuit = circuit_of(alone, 'main')
    advance(circuit, [1e-6], [0.0])
    assert circuit.samples[0]['heat'] > 0.0


def test_heat_of_the_tank_has_its_oil_and_metal() -> None:
    """860 kg/m3 x 1970 J/(kg K) x 0.5 l + 120 J/K."""
    heat = sheet_of(HOT).heat
    assert isinstance(heat, MixedHeat)
    assert heat_capacity(heat) == pytest.approx(967.1, rel=1e-12)


@pytest.mark.parametrize(('text', 'message'), [
    (SIMPLE + COOLER, 'parts.cooler: the oil has no heat to give; parts.tank.heat.kind must be '
                      'mixed'),
    (HOT.replace('start_celsius: 31.0', 'start_celsius: 90.0'),
     'parts.tank.heat.start_celsius = 90 celsius, must be <= 80'),
    (HOT.replace('oil_volume_l: 0.5, m', 'oil_volume_l: 0.0, m'), 'must be > 0 l'),
    (HOT.replace('efficiency_percent: 85.0', 'efficiency_percent: 9.0'), 'must be >= 10 %'),
    (HOT.replace('w_per_k: 40.0', 'w_per_k: -1.0'), 'parts.cooler.w_per_k = -1 W/K, must be >= 0'),
])
def test_what_cannot_be_is_refused(text: str, message: str) -> None:
    with pytest.raises(ParameterError) as refused:
        sheet_of(text)
    assert message in str(refused.value)


def test_compiled_is_its_source() -> None:
    """Bit for bit."""
    found = []
    for function in (warm_oil, warm_oil.py_func):
        oil: np.record = rows_of(1, OIL_STATE)[0]
        oil.celsius, given = 31.0, np.zeros(2)
        function(1e-3, 0.7, 967.1, np.array([(3.0, 17.0), (40.0, 12.0)]), oil, given)
        found.append(oil.tobytes() + given.tobytes())
    assert found[0] == found[1]
