"""Warm oil over a run: one ODE by scipy, the balance of heat, saved states, steps of cold oil."""

import math

from isa_ros.core.signals import LOAD_REPLY, SUPPLY_REPLY
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.surroundings.circuits import warmth
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.heat import MixedHeat
from isa_ros.surroundings.circuits.warmth import STEP
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.surroundings.circuits.advanced import advance
from tests.surroundings.circuits.sheets import circuit_of, MS, sheet_of, SLOPE
from tests.surroundings.circuits.station import driven, LPM, surplus
from tests.surroundings.circuits.test_heat import CAPACITY, HOT, HOT_STATION, walther


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
        advance(circuit, [drawn * 1e-3], [0.5 * drawn * 1e-3], [float(x[3])])
        assert circuit.samples[0]['oil_temperature'] == pytest.approx(x[2], abs=bound)
        own = circuit._warmth
        assert own is not None and abs(own.oil.celsius - own.oil.taken) <= step
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
            advance(circuit, [8.0 * LPM * 1e-3], [3.0 * LPM * 1e-3])
    else:
        driven(circuit, 500, rng)
    whole = circuit.samples[0]
    assert whole['heat'] > 500.0 and abs(whole['oil_temperature'] - 31.0) > 5 * STEP
    assert unbalanced(circuit, text) == pytest.approx(0.0, abs=1e-9 * float(whole['heat']))
    throughput = abs(float(whole['pump_energy'])) + abs(float(whole['energy']))
    assert abs(surplus(circuit)) < 1e-6 * throughput
    # the parts have what the whole has lost, what softer oil has given among it
    tank = circuit._network.node('tank')
    paid = float(circuit._network.nodes[tank]['p_held'] * circuit.state[tank])
    assert float(circuit.samples[1:]['relief_energy'].sum()) == pytest.approx(
        float(whole['relief_energy'] + whole['return_energy']) - paid, abs=1e-9 * throughput)


GAS = 'buffer: {kind: accumulator, at: main, gas_volume_l: 0.5, precharge_mpa: 12.0, ' \
    'thermal_time_constant_s: 0.1}\n'


@pytest.mark.parametrize('more', ['', GAS])
def test_the_heat_is_that_of_losses_shafts_and_actuators(more: str) -> None:
    """T8: what the shaft gave, less what the oil stores, and what actuators and gas kept."""
    text = HOT.replace('leakage_lpm_per_mpa: 0.1', 'leakage_lpm_per_mpa: 0.0') + more
    circuit = circuit_of(text, 'main')
    for _ in range(400):
        advance(circuit, [8.0 * LPM * 1e-3], [3.0 * LPM * 1e-3])
    whole = circuit.samples[0]
    shaft = float(whole['pump_energy']) / 0.85
    of_gas = float(row(circuit, text, 'buffer')['relief_energy']) if more else 0.0
    assert not more or abs(of_gas) > 50.0
    assert float(whole['heat']) == pytest.approx(
        shaft - float(whole['pump_energy']) + float(whole['relief_energy']) - of_gas
        + float(whole['return_energy']) + 0.9 * float(whole['energy']), rel=1e-12, abs=0.0)
    assert shaft - float(whole['pump_energy']) > 200.0


def test_heat_of_actuators_takes_the_place_of_their_energy() -> None:
    """T10: of those with a temperature of their own, at two manifolds; s of the others' E1."""
    plain = circuit_of(HOT_STATION, 'left', 'right')
    own = Circuit(sheet_of(HOT_STATION), MS, [
        Fed('left', SLOPE, rows=(2, 0), heated=(2,)),
        Fed('right', SLOPE, rows=(1, 3), heated=(3,))])
    backs = [back for _, back in plain.pressures]
    advance(plain, [2e-6, 3e-6], [1e-6, 1.5e-6], [30.0, 50.0])
    replies, answers = np.zeros(4, LOAD_REPLY), np.zeros(4, SUPPLY_REPLY)
    replies['supply_volume'] = 1.5e-6, 1e-6, 0.5e-6, 2e-6
    replies['return_volume'] = 6e-7, 6e-7, 4e-7, 9e-7
    answers['paid'] = 18.0, 21.0, 12.0, 29.0
    answers['heat'] = 100.0, 200.0, 7.0, -3.0     # of others it is not asked for
    own.advancing.to(replies, answers).run()
    own.settle()
    heat = plain._sheet.heat
    assert isinstance(heat, MixedHeat)
    taken = 12.0 + 29.0 - backs[0] * 4e-7 - backs[1] * 9e-7
    assert float(own.samples[0]['heat'] - plain.samples[0]['heat']) == pytest.approx(
        7.0 - 3.0 - 0.01 * heat.actuators_percent * taken, rel=1e-9)
    for name in ('energy', 'drawn', 'returned'):
        assert own.samples[0][name] == pytest.approx(plain.samples[0][name], rel=1e-12, abs=0.0)


def test_what_leaks_to_the_outside_takes_its_heat_along() -> None:
    """T8: of a manifold that leaks, the heat is all but the leak's."""
    text = HOT.replace('oil_volume_l: 0.5}', 'oil_volume_l: 0.5, leakage_lpm_per_mpa: 0.3}')
    circuit = circuit_of(text, 'main')
    for _ in range(300):
        advance(circuit, [1e-12], [0.0])
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


def test_a_fouled_cooler_gives_less() -> None:
    """By its share, and none is given to a coolant as warm as the oil."""
    given = []
    for more in ('', ', fouled: 0.25', ', fouled: 1.0'):
        text = HOT.replace('coolant_celsius: 12.0', f'coolant_celsius: 12.0{more}')
        circuit = circuit_of(text, 'main')
        for _ in range(20):
            advance(circuit, [0.0], [0.0])
        given.append(float(row(circuit, text, 'cooler')['heat']))
    assert given[0] > 10.0 and given[2] == 0.0
    assert given[1] == pytest.approx(0.75 * given[0], rel=1e-3)


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


def test_oil_that_is_still_cold_keeps_its_steps() -> None:
    """After a cold coolant has gone, by the temperature that the oil has."""
    cold = HOT_STATION.replace('12.0}', '-30.0}').replace('w_per_k: 40.0', 'w_per_k: 1.0e+6')
    circuit = circuit_of(cold, 'left', 'right')
    steps = circuit._steps
    for _ in range(20):
        advance(circuit, [0.0, 0.0], [0.0, 0.0])
    assert circuit.samples[0]['oil_temperature'] < -29.0
    mild = sheet_of(
        cold.replace('-30.0}', '31.0}').replace('air_celsius: 17.0', 'air_celsius: 31.0'))
    circuit.change(mild)
    assert abs(circuit._steps - steps) <= 1 < steps - circuit_of(
        HOT_STATION.replace('12.0}', '31.0}'), 'left', 'right')._steps


def test_a_manifold_must_be_large_enough_for_cold_oil() -> None:
    """C16 with oil of -30 celsius, 0.685 times as soft: four plant steps are 80 us."""
    slope, volume = 1e-9, 0.11
    for coolant, is_refused in ((31.0, False), (-30.0, True)):
        text = HOT.replace('oil_volume_l: 0.5}', f'oil_volume_l: {volume}}}').replace(
            'coolant_celsius: 12.0', f'coolant_celsius: {coolant}').replace(
            'air_celsius: 17.0', 'air_celsius: 31.0')
        if is_refused:
            with pytest.raises(ParameterError, match='parts.main: capacity over flow slope'):
                Circuit(sheet_of(text), MS, [Fed('main', slope)])
        else:
            Circuit(sheet_of(text), MS, [Fed('main', slope)])


@pytest.mark.parametrize(('place', 'value'), [(0, -61.0), (1, -61.0), (1, 5001.0), (3, np.inf)])
def test_a_saved_state_of_no_oil_is_refused(place: int, value: float) -> None:
    """Temperatures that no equation holds at, and what is not finite."""
    circuit = circuit_of(HOT_STATION, 'left', 'right')
    numbers = np.frombuffer(circuit.snapshot()).copy()
    circuit.refuse_snapshot(numbers.tobytes())
    numbers[circuit._heat_at + place] = value
    with pytest.raises(ConfigError, match='saved state is not one of this circuit'):
        circuit.refuse_snapshot(numbers.tobytes())


def test_air_may_change_during_a_run() -> None:
    """The walls follow at once."""
    circuit, held = circuit_of(HOT, 'main'), []
    for air in ('17.0', '-20.0'):
        text = HOT.replace('air_celsius: 17.0', f'air_celsius: {air}')
        circuit.change(sheet_of(text))
        before = float(row(circuit, text, 'tank')['heat'])
        advance(circuit, [0.0], [0.0])
        held.append(float(row(circuit, text, 'tank')['heat']) - before)
    # 3 W/K over 1 ms of 14 and 51 K
    assert held == [pytest.approx(0.042, rel=0.01), pytest.approx(0.153, rel=0.01)]
