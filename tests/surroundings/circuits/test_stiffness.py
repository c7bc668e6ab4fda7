"""The bound of the fastest motion, and what is refused by it."""

import math

from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits import stiffness
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.network import OF_LINE, OF_PUMP
from isa_ros.surroundings.circuits.plan import Network, network_of
import numpy as np
import pytest
from tests.surroundings.circuits.sheets import circuit_of, MS, sheet_of, SIMPLE, SLOPE
from tests.surroundings.circuits.station import STATION


def linearised(network: Network) -> np.ndarray:
    """Return the matrix of the network with the steepest slopes, contents first."""
    n, m = len(network.nodes), len(network.elements)
    a = np.zeros((n + m, n + m))
    for j, element in enumerate(network.elements):
        slope, inverse, own = stiffness._slopes(element)
        ends = ((int(element['inlet']), 1.0), (int(element['outlet']), -1.0))
        for k, sign in ends:
            for other, way in ends:
                if not network.nodes[other]['is_held']:
                    a[k, other] -= sign * way * slope / network.nodes[other]['c']
            if element['law'] in (OF_LINE, OF_PUMP):
                a[k, n + j] -= sign
            if inverse and not network.nodes[k]['is_held']:
                a[n + j, k] += sign * inverse / network.nodes[k]['c']
        a[n + j, n + j] -= own
    free = [k for k in range(n) if not network.nodes[k]['is_held']] + list(range(n, n + m))
    return a[np.ix_(free, free)]


@pytest.mark.parametrize('text', [
    STATION, SIMPLE, STATION.replace('length_m: 2.0', 'length_m: 0.2'),
    STATION.replace('lpm_per_mpa: 200.0', 'lpm_per_mpa: 2000.0'),
    STATION.replace('bore_mm: 12.0', 'bore_mm: 40.0, lumps: 20')])
def test_the_bound_is_above_all_eigenvalues_and_not_far(text: str) -> None:
    """C53 against numpy's eigenvalues; Gershgorin's circles are within a factor of four."""
    network = network_of(sheet_of(text))
    bound = sum(rate.value for rate in stiffness.rates(network))
    fastest = abs(np.linalg.eigvals(linearised(network))).max()
    assert fastest <= bound < 4.0 * fastest


@pytest.mark.parametrize(('text', 'said'), [
    (STATION.replace('stored: {kind: manifold, oil_volume_l: 0.5}',
                     'stored: {kind: manifold, oil_volume_l: 0.001}'),
     r'supply: parts\.stored: its pressure changes at [\d.e+]+ 1/s by \w+, all of the circuit at '
     r'[\d.e+]+ 1/s, must be <= 5e\+05 1/s \(steps of 2 us\); enlarge its oil_volume_l'),
    (STATION.replace('length_m: 2.0', 'length_m: 1.0e-6'),
     r'supply: parts.hose: its pressure changes at \S+ 1/s, all .*; enlarge its length_m'),
    (STATION.replace('length_m: 2.0', 'length_m: 0.02, lumps: 64'),
     r'supply: parts\.hose: .* by hose.*|supply: parts\.hose: its pressure changes at .*; '
     'reduce its lumps')])
def test_what_cannot_be_integrated_is_refused_by_name(text: str, said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        circuit_of(text, 'left', 'right')


@pytest.mark.parametrize('more', [
    '', 'buffer: {kind: accumulator, at: main, gas_volume_l: 5.0, precharge_mpa: 10.0}\n'])
def test_a_manifold_that_does_not_hold_its_pressure_is_refused(more: str) -> None:
    """C/slope below four plant steps (C16), of the oil that is left of an empty accumulator."""
    with pytest.raises(ParameterError, match=(
            r'supply: parts\.main: capacity over flow slope of its actuators = [\d.]+ ms, must be '
            r'>= 0.08 ms \(four plant steps\); enlarge its oil_volume_l')):
        Circuit(sheet_of(SIMPLE + more), MS, [Fed('main', 1e4 * SLOPE)])


def test_rates_are_those_of_one_manifold() -> None:
    """Pump at a manifold: decay g/C, the compensator's loop q_max/(band T C), 1/T."""
    network = network_of(sheet_of(SIMPLE))
    decay, swing, own = stiffness.rates(network)
    c, lpm = 0.5e-3 / 1.2e9, 1e-3 / 60.0
    assert decay.value == pytest.approx(0.1e-6 * lpm / c, rel=1e-12)
    assert swing.value == pytest.approx(math.sqrt(15.0 * lpm / (0.5e6 * 0.03) / c), rel=1e-12)
    assert own.value == pytest.approx(1.0 / 0.03, rel=1e-12)
    assert (decay.place, decay.part, own.part) == ('main', 'pump', 'pump')
