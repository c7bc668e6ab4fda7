"""Valves of a circuit: switched, opened by the flow, and their faults."""

import numpy as np
import pytest
from tests.surroundings.circuits.advanced import advance
from tests.surroundings.circuits.sheets import circuit_of, sheet_of, SIMPLE
from tests.surroundings.circuits.station import LPM, STATION


def test_the_emergency_stop_dumps_and_shuts() -> None:
    """Without current the pump stands, the dump opens, the block valve keeps what is behind it."""
    circuit = circuit_of(STATION, 'left', 'right')
    for _ in range(100):
        advance(circuit, [0.0, 0.0], [0.0, 0.0])
    kept = circuit.pressures[1][0]
    circuit.change(sheet_of(STATION, dump={'opened': 1.0}))
    for _ in range(1500):
        advance(circuit, [0.0, 0.0], [0.0, 0.0])
    assert circuit.pressures[0][0] < 1e6
    assert circuit.pressures[1][0] > 0.9 * kept
    assert circuit.samples[0]['dump_opening'] == pytest.approx(1.0, abs=1e-6)
    assert circuit.samples[0]['pump_flow'] < 0.0      # only its leakage, back to the tank
    circuit.change(sheet_of(STATION))
    for _ in range(1500):
        advance(circuit, [0.0, 0.0], [0.0, 0.0])
    assert circuit.pressures[0][0] > 15e6


def test_the_unloading_valve_goes_to_and_fro() -> None:
    """Between its two pressures it stays as it is; the check valve keeps the accumulator full."""
    circuit = circuit_of(STATION, 'left', 'right')
    stored, openings = [], []
    row = 1 + list(sheet_of(STATION).by_name).index('spared')
    for _ in range(3000):
        advance(circuit, [3.0 * LPM * 1e-3, 0.0], [0.0, 0.0])
        stored.append(float(circuit.samples[row + 2]['pressure']))
        openings.append(float(circuit.samples[row]['dump_opening']))
    full = np.array(openings) > 0.99
    shut = np.array(openings) < 0.01
    changes = np.count_nonzero(np.diff(full[full | shut]))
    assert changes >= 4
    # the lag of 20 ms lets it overshoot by what flows meanwhile
    assert min(stored) == pytest.approx(18e6, abs=0.3e6)
    assert max(stored) == pytest.approx(19.5e6, abs=0.6e6)


@pytest.mark.parametrize(('fault', 'low', 'high'), [
    ('stuck_shut: 1', 0.0, 15e6), ('spring_broken: 1', 18e6, 20e6), ('', 18e6, 20e6)])
def test_faults_of_the_check_valve(fault: str, low: float, high: float) -> None:
    """Stuck shut, the manifold behind it empties."""
    text = STATION.replace('rated_lpm: 60.0}\nstored', f'rated_lpm: 60.0, {fault}}}\nstored')
    circuit = circuit_of(text, 'left', 'right')
    for _ in range(1500):
        advance(circuit, [4.0 * LPM * 1e-3, 0.0], [0.0, 0.0])
    assert low <= circuit.pressures[0][0] <= high


def test_a_check_valve_lets_no_oil_back_unless_it_sticks() -> None:
    """With the pump standing and leaking, the gallery empties and the accumulator does not."""
    stands = STATION.replace('speed_rpm: 1500.0', 'speed_rpm: 0.0')
    for fault, is_kept in (('', True), (', stuck_open: 1', False),
                           (', leakage_lpm_per_mpa: 5.0', False)):
        text = stands.replace('rated_lpm: 60.0}\nstored', f'rated_lpm: 60.0{fault}}}\nstored')
        circuit = circuit_of(text.replace('leakage_lpm_per_mpa: 0.05', 'leakage_lpm_per_mpa: 2.0'),
                             'left', 'right')
        for _ in range(1000):
            advance(circuit, [0.0, 0.0], [0.0, 0.0])
        assert (circuit.pressures[0][0] > 17e6) == is_kept


def test_a_stuck_pump_and_a_stuck_valve_stay_as_they_are() -> None:
    circuit = circuit_of(STATION, 'left', 'right')
    for _ in range(200):
        advance(circuit, [5.0 * LPM * 1e-3, 0.0], [0.0, 0.0])
    row = 1 + list(sheet_of(STATION).by_name).index('dumped')
    stuck = STATION.replace('inlet: stored, outlet: tank, rated', 'stuck: 1, inlet: stored, '
                            'outlet: tank, rated').replace('speed_rpm', 'stuck: 1, speed_rpm')
    own = circuit._network.of('pump')[0] + 4 * len(circuit._network.nodes)
    circuit.change(sheet_of(stuck))
    flow = circuit.state[own]
    circuit.change(sheet_of(stuck, dump={'opened': 1.0}))
    for _ in range(50):
        advance(circuit, [0.0, 0.0], [0.0, 0.0])
    assert circuit.state[own] == flow > 0.0
    assert circuit.samples[row]['dump_opening'] == 0.0


@pytest.mark.parametrize(('fault', 'expected'), [
    ('', 15.0), (', stuck_shut: 1', 19.93), (', spring_broken: 1', 0.245),
    (', stuck_shut: 1, leakage_lpm_per_mpa: 0.5', 19.6)])
def test_faults_of_the_relief_valve(fault: str, expected: float) -> None:
    """
    15 l/min of a pump at 20 MPa, leakage 0.1 l/min/MPa, through 60 l/min/MPa above 15 MPa.

    Open the pressure is that of opening and (15 - 1.5)/60 MPa, without its spring 15/60 MPa; shut
    it is the compensator's, lower by its band times the share of what leaks.
    """
    text = SIMPLE + 'safety: {kind: relief, inlet: main, outlet: tank, opens_mpa: 15.0, ' \
        f'lpm_per_mpa: 60.0{fault}}}\n'
    circuit = circuit_of(text, 'main')
    for _ in range(1000):
        advance(circuit, [0.0], [0.0])
    p = circuit.pressures[0][0] * 1e-6
    if fault == '':
        expected += (15.0 - 0.1 * p) / 60.0
    assert p == pytest.approx(expected, abs=0.02)


def test_a_check_valve_opens_at_its_pressure_or_without_its_spring() -> None:
    """Between both is the opening pressure, at the same flow (C51)."""
    drops = []
    for fault in ('', ', spring_broken: 1'):
        circuit = circuit_of(
            SIMPLE + 'behind: {kind: manifold, oil_volume_l: 0.5}\n'
            'kept: {kind: check, inlet: main, outlet: behind, rated_lpm: 6.0, rated_drop_mpa: '
            f'0.4, opens_mpa: 0.5{fault}}}\n', 'behind')
        for _ in range(1000):
            advance(circuit, [6.0 * LPM * 1e-3], [0.0])
        row = 1 + list(sheet_of(SIMPLE).by_name).index('main')
        drops.append(float(circuit.samples[row]['pressure']) - circuit.pressures[0][0])
    # the rated drop is that of a square root; V5 makes it larger by (delta/dP)^2/2, 0.13 %
    assert drops == pytest.approx([0.9e6, 0.4e6], abs=1e3)
