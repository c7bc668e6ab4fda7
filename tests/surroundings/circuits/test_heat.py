"""Heat of a circuit: one ODE by scipy, the balance of heat, walls and coolers, thinner oil."""

import math

from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits import warmth
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.heat import (
    coldest, heat_capacity, MixedHeat, OIL_STATE, warm_oil)
from isa_ros.surroundings.circuits.line import lump_fields
from isa_ros.surroundings.circuits.oil import oil_at_sheet
from isa_ros.surroundings.circuits.plan import network_of
from isa_ros.surroundings.circuits.warmth import coldest_oil, STEP
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.surroundings.circuits.sheets import circuit_of, sheet_of, SIMPLE
from tests.surroundings.circuits.test_circuit import driven, LPM, STATION, surplus

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


def row(circuit: Circuit, text: str, name: str) -> np.void:
    """Return the sample of a part."""
    found: np.void = circuit.samples[1 + list(sheet_of(text).by_name).index(name)]
    return found


def unbalanced(circuit: Circuit, text: str, start: float = 31.0) -> float:
    """Return what the balance of heat lacks (T7), J."""
    whole = circuit.samples[0]
    given = [float(row(circuit, text, name)['heat']) for name in ('tank', 'cooler')]
    return float(whole['heat'] - given[0] - given[1]
                 - CAPACITY * (whole['oil_temperature'] - start))


def walther(celsius: float) -> float:
    """Return nu of an ISO VG 32 by two points, mm2/s."""
    def ordinate(nu: float) -> float:
        return math.log(math.log(nu + 0.7))
    slope = (ordinate(32.0) - ordinate(5.4)) / math.log(373.15 / 313.15)
    return math.exp(math.exp(
        ordinate(32.0) - slope * math.log((celsius + 273.15) / 313.15))) - 0.7


@pytest.mark.parametrize(('step', 'bound'), [(0.0, 1e-5), (STEP, 1.7e-3)])
def test_it_follows_one_ode_by_scipy(
        step: float, bound: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """
    T7 to T9 with C45, C47 and C50: pump with friction and leakage, relief valve, walls, cooler.

    With properties that follow at every tick; and in steps of 0.05 K, with which the leakage, of
    540 W, errs by at most 0.2 % of itself: 1.6 J in 1.5 s.
    """
    monkeypatch.setattr(warmth, 'STEP', step)
    circuit, q_max = circuit_of(HOT, 'main'), 10e-6 * 25.0
    thickness = {celsius: walther(celsius) / walther(40.0) for celsius in (31.0, 40.0)}
    assert thickness[31.0] > 1.4

    def rates(t: float, x: np.ndarray, drawn: float) -> list[float]:
        content, q, theta, _ = x
        p = content * 1.2e9 / (1.0 + 4.5e-3 * (theta - 40.0)) / 0.5e-3
        leak = 0.1e-6 * LPM * p * walther(40.0) / walther(theta)
        demand = q_max * min(1.0, max(0.0, (20e6 - p) / 0.5e6))
        relief = 30e-6 * LPM * max(0.0, p - 18e6)
        heat = (p * q / 0.85 - p * (q - leak) + p * relief + 0.9 * p * drawn
                - 3.0 * (theta - 17.0) - 40.0 * (theta - 12.0))
        # of the oil in the manifold, D^2/(2 C) with D held and C growing by 0.45 % per kelvin
        released = 0.5 * p * p * 0.5e-3 / 1.2e9 * 4.5e-3
        return [q - leak - relief - drawn, (demand - q) / 0.03, heat / (CAPACITY - released),
                p * drawn]
    x = np.array([float(circuit.state[circuit._network.node('main')]), 0.0, 31.0, 0.0])
    assert circuit.pressures[0][0] == pytest.approx(18e6, rel=1e-12)
    for k in range(1500):
        drawn = LPM * (5.0 + 3.0 * math.sin(0.01 * k))
        x[3] = 0.0
        x = solve_ivp(rates, (0.0, 1e-3), x, args=(drawn,), rtol=1e-8,
                      atol=[1e-14, 1e-12, 1e-9, 1e-6]).y[:, -1]
        circuit.advance_nodes([drawn * 1e-3], [float(x[3])], [0.5 * drawn * 1e-3])
        assert circuit.samples[0]['oil_temperature'] == pytest.approx(x[2], abs=bound)
    assert x[2] > 33.0
    expected = x[0] * 1.2e9 / (1.0 + 4.5e-3 * (x[2] - 40.0)) / 0.5e-3
    assert circuit.pressures[0][0] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize('text', [HOT, HOT_STATION])
def test_all_heat_is_stored_or_given_away(text: str) -> None:
    """T7 within 1e-9 of the heat; and the energy of the oil closes as ever, E12."""
    fed = ('main',) if text is HOT else ('left', 'right')
    circuit, rng = circuit_of(text, *fed), np.random.default_rng(7)
    if text is HOT:
        for _ in range(500):
            circuit.advance_held([8.0 * LPM * 1e-3], [3.0 * LPM * 1e-3])
    else:
        driven(circuit, 500, rng)
    whole = circuit.samples[0]
    assert whole['heat'] > 500.0 and abs(whole['oil_temperature'] - 31.0) > 5 * STEP
    assert unbalanced(circuit, text) == pytest.approx(0.0, abs=1e-9 * float(whole['heat']))
    throughput = abs(float(whole['pump_energy'])) + abs(float(whole['energy']))
    assert abs(surplus(circuit)) < 1e-6 * throughput


def test_the_heat_is_that_of_losses_shafts_and_actuators() -> None:
    """T8: what the shaft gave, less what the oil stores, and what the actuators kept."""
    text = HOT.replace('leakage_lpm_per_mpa: 0.1', 'leakage_lpm_per_mpa: 0.0')
    circuit = circuit_of(text, 'main')
    for _ in range(400):
        circuit.advance_held([8.0 * LPM * 1e-3], [3.0 * LPM * 1e-3])
    whole = circuit.samples[0]
    shaft = float(whole['pump_energy']) / 0.85
    assert float(whole['heat']) == pytest.approx(
        shaft - float(whole['pump_energy']) + float(whole['relief_energy'])
        + float(whole['return_energy']) + 0.9 * float(whole['energy']), rel=1e-12, abs=0.0)
    assert shaft - float(whole['pump_energy']) > 200.0


def test_what_leaks_to_the_outside_takes_its_heat_along() -> None:
    """T8: of a manifold that leaks, the heat is all but the leak's."""
    text = HOT.replace('oil_volume_l: 0.5}', 'oil_volume_l: 0.5, leakage_lpm_per_mpa: 0.3}')
    circuit = circuit_of(text, 'main')
    for _ in range(300):
        circuit.advance_held([1e-12], [0.0])
    whole, leak = circuit.samples[0], row(circuit, text, 'main')
    pump = row(circuit, text, 'pump')
    lost = float(leak['relief_energy'])
    assert lost > 200.0
    g, p = 0.1e-6 * LPM, circuit.pressures[0][0]
    shaft = float(pump['pump_energy']) * (1.0 / 0.85 - 1.0)
    # the pump's leakage in oil of 31 celsius and more: 20 MPa over 0.3 s at nearly one pressure
    leaked = g * p * p * 0.3 / 0.85 * walther(40.0) / walther(31.3)
    assert float(whole['heat']) == pytest.approx(
        shaft + leaked + float(whole['relief_energy']) - lost, rel=0.01)


def test_walls_and_coolers_find_the_balance() -> None:
    """At rest of all but a loss of 1 kW: theta = (P + sum(G theta_k))/sum(G)."""
    oil: np.record = np.zeros(1, OIL_STATE).view(np.recarray)[0]
    oil.celsius = 31.0
    given, ways = np.zeros(2), np.array([(3.0, 17.0), (40.0, 12.0)])
    for _ in range(200):
        warm_oil(60.0, 60.0 * 1000.0, CAPACITY, ways, oil, given)
    assert float(oil.celsius) == pytest.approx((1000.0 + 3.0 * 17.0 + 40.0 * 12.0) / 43.0)
    # one step of hours is as exact as many short ones
    long: np.record = np.zeros(1, OIL_STATE).view(np.recarray)[0]
    long.celsius, once = 31.0, np.zeros(2)
    warm_oil(12000.0, 12000.0 * 1000.0, CAPACITY, ways, long, once)
    assert float(long.celsius) == pytest.approx(float(oil.celsius), rel=1e-12)
    assert once == pytest.approx(given, rel=1e-9)
    assert once[0] == pytest.approx(3.0 * 12000.0 * (oil.celsius - 17.0), rel=0.01)


def test_without_a_way_all_heat_stays() -> None:
    """T7 with G = 0."""
    oil: np.record = np.zeros(1, OIL_STATE).view(np.recarray)[0]
    oil.celsius, given = 20.0, np.zeros(1)
    warm_oil(5.0, 700.0, 350.0, np.array([(0.0, 17.0)]), oil, given)
    assert (float(oil.celsius), float(oil.got), given[0]) == (22.0, 700.0, 0.0)


def test_a_fouled_cooler_gives_less() -> None:
    """By its share, and none is given to a coolant as warm as the oil."""
    given = []
    for more in ('', ', fouled: 0.25', ', fouled: 1.0'):
        text = HOT.replace('coolant_celsius: 12.0', f'coolant_celsius: 12.0{more}')
        circuit = circuit_of(text, 'main')
        for _ in range(20):
            circuit.advance_held([0.0], [0.0])
        given.append(float(row(circuit, text, 'cooler')['heat']))
    assert given[0] > 10.0 and given[2] == 0.0
    assert given[1] == pytest.approx(0.75 * given[0], rel=1e-3)


def test_warm_oil_is_thinner_and_softer() -> None:
    """T9: of 31 celsius against the section's 40, by the equations of a data sheet."""
    sheet = sheet_of(HOT_STATION)
    cold, base = network_of(sheet, coldest_oil(sheet)), network_of(sheet)
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
    assert coldest_oil(sheet) == oil
    hose = sheet.by_name['hose']
    assert lump_fields(hose, oil) == tuple(   # type: ignore[arg-type]
        network_of(sheet).elements[network_of(sheet).of('hose')[0]]['line'].tolist())


def test_a_saved_state_has_temperature_and_heat() -> None:
    """And goes on byte for byte, in the middle of a step of the properties too."""
    circuit, other = (circuit_of(HOT_STATION, 'left', 'right') for _ in range(2))
    driven(circuit, 30, np.random.default_rng(2))
    saved, samples = circuit.snapshot(), circuit.samples.copy()
    assert len(saved) == circuit.saved_size
    assert abs(float(samples[0]['oil_temperature']) - 31.0) > 1e-3
    other.refuse_snapshot(saved)
    other.samples[:] = samples
    other.restore(saved)
    assert other.samples.tobytes() == circuit.samples.tobytes()
    assert other.nodes() == circuit.nodes()
    for one in (circuit, other):
        driven(one, 100, np.random.default_rng(3))
    assert circuit.snapshot() == other.snapshot()
    assert circuit.samples.tobytes() == other.samples.tobytes()


def test_steps_are_those_of_the_coldest_oil() -> None:
    """Thick and hard oil is faster: a colder coolant takes more steps of a tick."""
    warm, cold = (circuit_of(HOT_STATION.replace('12.0}', f'{celsius}}}'), 'left', 'right')
                  for celsius in (31.0, -30.0))
    assert cold._steps > warm._steps


def test_air_may_change_during_a_run() -> None:
    """The walls follow at once."""
    circuit, held = circuit_of(HOT, 'main'), []
    for air in ('17.0', '-20.0'):
        text = HOT.replace('air_celsius: 17.0', f'air_celsius: {air}')
        circuit.change(sheet_of(text))
        before = float(row(circuit, text, 'tank')['heat'])
        circuit.advance_held([0.0], [0.0])
        held.append(float(row(circuit, text, 'tank')['heat']) - before)
    # 3 W/K over 1 ms of 14 and 51 K
    assert held == [pytest.approx(0.042, rel=0.01), pytest.approx(0.153, rel=0.01)]


def test_nothing_colder_than_the_start_is_met_without_a_way() -> None:
    """Neither air nor coolant behind no conductance."""
    heat = sheet_of(HOT).heat
    assert isinstance(heat, MixedHeat)
    for ways, expected in (((0.0, -20.0), 31.0), ((2.0, -20.0), -20.0), ((2.0, 50.0), 31.0)):
        assert coldest(heat, np.array([ways])) == expected
    alone = SIMPLE.replace('kind: tank}', f'kind: tank, {HEAT}}}').replace(
        'walls_w_per_k: 3.0, ', '')
    assert coldest_oil(sheet_of(alone)).thickness == pytest.approx(walther(31.0) / 32.0)
    circuit = circuit_of(alone, 'main')
    circuit.advance_held([1e-6], [0.0])
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
        oil: np.record = np.zeros(1, OIL_STATE).view(np.recarray)[0]
        oil.celsius, given = 31.0, np.zeros(2)
        function(1e-3, 0.7, 967.1, np.array([(3.0, 17.0), (40.0, 12.0)]), oil, given)
        found.append(oil.tobytes() + given.tobytes())
    assert found[0] == found[1]
