"""Circuits as a whole: oil and energy, an independent model, switching, faults, saved states."""

from isa_ros.errors import ConfigError, RunError
from isa_ros.surroundings.circuits import network
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.sheet import CircuitSupply
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.surroundings.circuits.advanced import advance
from tests.surroundings.circuits.sheets import circuit_of, MS, sheet_of, SIMPLE, SLOPE
from tests.surroundings.circuits.station import driven, LPM, STATION, surplus

CHANGES = {     # tick: changes of the text
    100: ('rated_lpm: 60.0}\nstored', 'rated_lpm: 60.0, leakage_lpm_per_mpa: 0.5}\nstored'),
    160: ('length_m: 2.0', 'burst: 0.01, length_m: 2.0'),
    200: ('precharge_mpa: 12.0', 'precharge_mpa: 12.0, gas_lost: 0.6'),
    240: ('opens_mpa: 22.0', 'opens_mpa: 22.0, spring_broken: 1'),
    260: ('oil_volume_l: 0.3', 'oil_volume_l: 0.3, leakage_lpm_per_mpa: 0.1'),
    300: ('lpm_per_mpa: 200.0', 'lpm_per_mpa: 200.0, clogged: 0.9')}


@pytest.fixture(scope='module')
def driven_circuit() -> tuple[Circuit, float, float]:
    """Return a circuit of all parts after faults of many, its throughput, oil that is missing."""
    circuit = circuit_of(STATION, 'left', 'right')
    n = len(circuit._network.nodes)
    at_first, through, text = float(circuit.state[:n].sum()), 0.0, STATION
    rng = np.random.default_rng(1)
    for tick in range(0, 400, 20):
        if tick in CHANGES:
            assert CHANGES[tick][0] in text
            text = text.replace(*CHANGES[tick])
            circuit.change(sheet_of(text))
        if tick == 340:
            circuit.change(sheet_of(text, dump={'opened': 1.0}))
        through += driven(circuit, 20, rng)
    whole = circuit.samples[0]
    missing = float(circuit.state[:n].sum() + whole['drawn'] - whole['returned']) - at_first
    return circuit, through, missing


def test_oil_is_neither_made_nor_lost(driven_circuit: tuple[Circuit, float, float]) -> None:
    """Of nodes, tank and outside, within 1e-9 of what the actuators drew and returned."""
    _, through, missing = driven_circuit
    assert abs(missing) < 1e-9 * through


def test_the_energy_of_the_whole_closes(driven_circuit: tuple[Circuit, float, float]) -> None:
    """E12, within 1e-6 of what pump and actuators brought and took, through all faults."""
    circuit, _, _ = driven_circuit
    whole = circuit.samples[0]
    throughput = abs(float(whole['pump_energy'])) + abs(float(whole['energy']))
    assert throughput > 500.0
    assert abs(surplus(circuit)) < 1e-6 * throughput


def test_losses_are_those_of_the_parts(driven_circuit: tuple[Circuit, float, float]) -> None:
    """The rows of the parts add up to that of the whole."""
    circuit, _, _ = driven_circuit
    whole, parts = circuit.samples[0], circuit.samples[1:]
    tank = 0.2e6 * float(circuit.state[circuit._network.node('tank')])
    # sums of some ten terms of up to 1e4 J
    for field in ('pump_energy', 'energy', 'held_energy'):
        assert parts[field].sum() == pytest.approx(float(whole[field]), abs=1e-6)
    assert parts['stored_energy'].sum() == pytest.approx(float(whole['stored_energy']), abs=1e-6)
    assert parts['relief_energy'].sum() == pytest.approx(
        float(whole['relief_energy'] + whole['return_energy']) - tank, abs=1e-6)


def test_it_follows_an_independent_model() -> None:
    """C45, C47, C50 as one ODE of scipy: pump with leakage, manifold, relief valve, a leak."""
    parts = SIMPLE + 'safety: {kind: relief, inlet: main, outlet: tank, opens_mpa: 19.8, ' \
        'lpm_per_mpa: 30.0, leakage_lpm_per_mpa: 0.2}\n'
    circuit = circuit_of(parts, 'main')
    q_max, c, g = 10e-6 * 25.0, 0.5e-3 / 1.2e9, 0.1e-6 * LPM

    def rates(t: float, x: np.ndarray, drawn: float) -> list[float]:
        p, q = x
        demand = q_max * min(1.0, max(0.0, (20e6 - p) / 0.5e6))
        relief = 0.2e-6 * LPM * p + 30e-6 * LPM * max(0.0, p - 19.8e6)
        return [(q - g * p - relief - drawn) / c, (demand - q) / 0.03]
    x = np.array([19.8e6, 0.0])
    for k in range(150):
        drawn = LPM * (6.0 if k < 80 else -2.0)
        advance(circuit, [drawn * 1e-3], [0.0])
        x = solve_ivp(rates, (0.0, 1e-3), x, args=(drawn,), rtol=1e-10, atol=1e-9).y[:, -1]
        # a corner of max() inside a step of the RK4 (20 us) costs at most r h of its swing
        assert circuit.pressures[0][0] == pytest.approx(x[0], rel=2e-6)


def test_each_part_has_the_oil_that_came_and_went() -> None:
    """In less out is what a place took to be compressed; what one part gave, the next has got."""
    text = STATION.replace('length_m: 2.0', 'burst: 0.01, length_m: 2.0').replace(
        'oil_volume_l: 0.3', 'oil_volume_l: 0.3, leakage_lpm_per_mpa: 0.1')
    circuit = circuit_of(text, 'left', 'right')
    n = len(circuit._network.nodes)
    start, drawn, returned = circuit.state[:n].copy(), 2e-6, 1.5e-6
    for _ in range(100):
        advance(circuit, [drawn, 0.0], [returned, 0.0])
    rows = dict(zip(sheet_of(text).by_name, circuit.samples[1:]))
    taken = {place: float(circuit.state[k] - start[k])
             for k, place in enumerate(circuit._network.places)}

    def oil(part: str) -> tuple[float, float]:
        return float(rows[part]['drawn']), float(rows[part]['returned'])
    gave = oil('buffer')[1] - oil('buffer')[0]
    assert gave > 1e-5 and min(oil('buffer')) == 0.0
    for place in ('gallery', 'left', 'right', 'drain'):
        assert oil(place)[0] - oil(place)[1] == pytest.approx(taken[place], abs=1e-15)
    assert oil('stored')[0] - oil('stored')[1] == pytest.approx(
        taken['stored'] + gave, abs=1e-15)
    assert oil('tank')[0] - oil('tank')[1] == pytest.approx(taken['tank'], abs=1e-15)
    assert oil('left')[0] == oil('hose')[1]
    # what the actuators drew, and what is outside by leak and tear
    assert oil('left')[1] == pytest.approx(100 * drawn + float(circuit.state[0]), abs=1e-15)
    assert circuit.state[0] > 1e-5
    assert oil('drain')[0] == pytest.approx(100 * returned, abs=1e-15)
    assert oil('tank')[1] == oil('pump')[0] > 0.0


def test_the_energy_closes_with_another_pressure_of_the_tank() -> None:
    """E12: oil that it has is paid at the pressure that it came at; 0 to 2 MPa and back."""
    circuit, rng = circuit_of(STATION, 'left', 'right'), np.random.default_rng(5)
    for pressure in ('0.2', '2.0', '0.0'):
        circuit.change(sheet_of(STATION.replace('pressure_mpa: 0.2', f'pressure_mpa: {pressure}')))
        driven(circuit, 40, rng)
    whole = circuit.samples[0]
    throughput = abs(float(whole['pump_energy'])) + abs(float(whole['energy']))
    # the rest is the step in which a relief valve opens
    assert abs(surplus(circuit)) < 1e-6 * throughput


def test_the_power_limit_is_felt() -> None:
    """C47: 6 kW at 20 MPa are 18 l/min, of 30 l/min that the displacement gives."""
    limited = SIMPLE.replace('displacement_ml: 10.0', 'displacement_ml: 20.0, power_w: 1000.0')
    circuit = circuit_of(limited, 'main')
    for _ in range(2000):
        advance(circuit, [15.0 * LPM * 1e-3], [0.0])
    p, own = circuit.pressures[0][0], circuit.samples[2]
    # at rest leakage and what is drawn are the whole flow
    assert own['pump_flow'] == pytest.approx(15.0 * LPM, rel=1e-3, abs=0.0)
    assert p * (15.0 * LPM + 0.1e-6 * LPM * p) == pytest.approx(1000.0, rel=1e-3)


def test_the_compensator_holds_the_pressure() -> None:
    """At 6 of 15 l/min, with leakage, the pressure is that share of the band lower."""
    circuit = circuit_of(SIMPLE, 'main')
    for _ in range(1000):
        advance(circuit, [6.0 * LPM * 1e-3], [0.0])
    p = circuit.pressures[0][0]
    share = (6.0 * LPM + 0.1e-6 * LPM * p) / (15.0 * LPM)
    assert p == pytest.approx(20e6 - 0.5e6 * share, abs=10.0)


def test_at_the_start_the_feeding_side_is_at_the_lowest_opening() -> None:
    """19.5 MPa of the unloading valve, below pump and relief; the return side as the tank."""
    circuit = circuit_of(STATION, 'left', 'right')
    assert circuit.pressures == [pytest.approx((19.5e6, 0.2e6), rel=1e-12, abs=1e-3)] * 2


def test_the_return_side_has_its_pressure() -> None:
    """6 l/min through 200 l/min/MPa are 0.03 MPa above the tank; the bypass helps from 0.35."""
    circuit = circuit_of(STATION, 'left', 'right')
    for _ in range(300):
        advance(circuit, [0.0, 0.0], [6.0 * LPM * 1e-3, 0.0])
    assert circuit.pressures[0][1] == pytest.approx(0.23e6, abs=10.0)
    assert circuit.pressures[1][1] == circuit.pressures[0][1]
    left = circuit.samples[1 + list(sheet_of(STATION).by_name).index('left')]
    # what is given back has the energy of its pressure, and the actuators are paid for it (E1)
    assert left['power'] == pytest.approx(-0.23e6 * 6.0 * LPM, rel=1e-4, abs=0.0)
    dirty = STATION.replace('lpm_per_mpa: 200.0', 'lpm_per_mpa: 200.0, clogged: 1.0')
    circuit.change(sheet_of(dirty))
    for _ in range(300):
        advance(circuit, [0.0, 0.0], [6.0 * LPM * 1e-3, 0.0])
    assert circuit.pressures[0][1] == pytest.approx(0.2e6 + 0.35e6 + 0.03e6, abs=10.0)


def test_power_is_that_of_the_tick_and_its_peak_the_largest() -> None:
    """E1 over the tick, W, of the whole and of both manifolds, whose peaks are at other ticks."""
    circuit, powers = circuit_of(STATION, 'left', 'right'), []
    at = [0, circuit._row_of['left'], circuit._row_of['right']]
    for drawn in ((6.0, 3.0), (9.0, 1.0), (2.0, 5.0), (1.0, 2.0)):
        before = circuit.samples['energy'][at]
        advance(circuit, [flow * LPM * 1e-3 for flow in drawn], [1e-6, 2e-6])
        powers.append(circuit.samples['power'][at])
        grown = (circuit.samples['energy'][at] - before) / 1e-3
        assert powers[-1] == pytest.approx(grown, rel=1e-9, abs=0.0)
    assert np.argmax(powers, axis=0).tolist() == [0, 1, 0]
    assert circuit.samples['peak_power'][at].tolist() == np.max(powers, axis=0).tolist()
    assert min(np.max(powers, axis=0)) > 500.0


def test_what_its_port_says_is_what_it_does() -> None:
    """Inflow, capacity, slope and trend at a manifold against a step of the network itself."""
    circuit = circuit_of(STATION, 'left', 'right')
    for _ in range(50):
        advance(circuit, [6.0 * LPM * 1e-3, 2.0 * LPM * 1e-3], [0.0, 0.0])
    for own, node in zip(circuit.nodes(), circuit._nodes):
        n = len(circuit._network.nodes)
        state = circuit.state.copy()
        work = np.zeros((network.WORK_ROWS, len(state)))
        h = 1e-7
        network.circuit_advance(1, h, np.zeros(n), circuit._network.nodes,
                                circuit._network.elements, state, work)
        # over h the inflow changes by trend h + slope/C inflow h, and C by less
        assert (work[0, node] - own.pressure) / h * own.capacity == pytest.approx(
            own.inflow, rel=1e-3, abs=1e-9)
        rates = np.zeros(len(state))
        network.circuit_rates(state, np.zeros(n), circuit._network.nodes,
                              circuit._network.elements, work[1], rates)
        rise = work[0, node] - own.pressure
        assert rates[node] - own.inflow == pytest.approx(
            own.trend * h - own.slope * rise, rel=0.02, abs=1e-12)


def test_a_saved_state_goes_on_byte_for_byte() -> None:
    """State and samples, after flows and a change."""
    circuit, other = (circuit_of(STATION, 'left', 'right') for _ in range(2))
    driven(circuit, 30, np.random.default_rng(2))
    saved, samples = circuit.snapshot(), circuit.samples.copy()
    other.refuse_snapshot(saved)
    other.samples[:] = samples
    other.restore(saved)
    assert other.nodes() == circuit.nodes()
    for one in (circuit, other):
        driven(one, 30, np.random.default_rng(3))
    assert circuit.snapshot() == other.snapshot()
    assert circuit.samples.tobytes() == other.samples.tobytes()


def test_other_states_are_neither_saved_nor_restored() -> None:
    circuit = circuit_of(STATION, 'left', 'right')
    for snapshot in (circuit.snapshot()[:-8], b'\xff' * len(circuit.snapshot())):
        with pytest.raises(ConfigError, match='supply: saved state is not one of this circuit'):
            circuit.refuse_snapshot(snapshot)
    circuit.state[3] = np.nan
    with pytest.raises(RunError, match='not finite'):
        circuit.snapshot()


def test_what_leaks_is_outside() -> None:
    """The manifold's leak and a tear, by the oil that node 0 has."""
    leaking = SIMPLE.replace('oil_volume_l: 0.5', 'oil_volume_l: 0.5, leakage_lpm_per_mpa: 0.3')
    circuit = circuit_of(leaking, 'main')
    for _ in range(1000):
        advance(circuit, [0.0], [0.0])
    # 6 l/min at 20 MPa, once the pump has found its new flow
    assert circuit.state[0] == pytest.approx(0.3 * 19.7 * LPM, rel=0.02, abs=0.0)
    assert surplus(circuit) == pytest.approx(0.0, abs=1e-6 * float(
        circuit.samples[0]['pump_energy']))


def test_compiled_is_its_source() -> None:
    """All rates of a network in motion, bit for bit."""
    circuit = circuit_of(STATION, 'left', 'right')
    driven(circuit, 20, np.random.default_rng(4))
    own = circuit._network
    n, size = len(own.nodes), len(circuit.state)
    flows = np.full(n, 1e-5)
    found = []
    for function in (network.circuit_rates, network.circuit_rates.py_func):
        rates, pressures = np.zeros(size), np.zeros(size)
        function(circuit.state, flows, own.nodes, own.elements, pressures, rates)
        found.append((rates.tobytes(), pressures.tobytes()))
    assert found[0] == found[1]


def test_the_tick_is_cut_by_its_fastest_motion() -> None:
    """Twice the tick, twice the steps."""
    sheet = sheet_of(STATION)
    assert isinstance(sheet, CircuitSupply)
    fed = [Fed('left', SLOPE), Fed('right', SLOPE)]
    one, two = Circuit(sheet, MS, fed), Circuit(sheet, 2 * MS, fed)
    assert two._steps == pytest.approx(2 * one._steps, abs=1)
    assert one._steps > 10
