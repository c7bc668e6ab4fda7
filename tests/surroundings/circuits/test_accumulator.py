"""Accumulators: isothermal, adiabatic and between, oil below precharge, lost gas."""

import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.surroundings.circuits.nodes import gas_volume
import numpy as np
import pytest
from tests.surroundings.circuits.sheets import Bench, circuit_of, SIMPLE

TAU, KAPPA = 0.05, 1.4
BUFFER = 'buffer: {kind: accumulator, at: main, gas_volume_l: 1.0, precharge_mpa: 10.0, ' \
    'thermal_time_constant_s: 0.05}\n'
STANDS = SIMPLE.replace('1500.0, leakage_lpm_per_mpa: 0.1', '0.0').replace(
    'oil_volume_l: 0.5', 'oil_volume_l: 1.0e-3')


def compliance(omega: float) -> complex:
    """Return the measured dV/dP of accumulator and oil at a frequency, m3/Pa."""
    bench = Bench(STANDS + BUFFER)
    bench.put('main', 15e6)
    main = bench.network.node('main')
    per_period, periods = 200, 4 if omega * TAU > 0.03 else 2
    h = 2.0 * math.pi / omega / per_period
    inner = max(1, math.ceil(h / (0.05 * TAU)))
    # 0.1 % of the volume: the gas law's curvature is below 1e-3 of the swing
    volume = float(gas_volume(15e6, bench.state[bench.n + main], bench.network.nodes[main]))
    amplitude = 1e-3 * volume * omega
    pressures, oil = [], []
    for k in range(per_period * periods):
        # the mean of the cosine over the interval, so that the oil is exactly a sine
        bench.drawn[main] = -amplitude / omega / h * (
            math.sin(omega * h * (k + 1)) - math.sin(omega * h * k))
        bench.advance(inner, h / inner)
        pressures.append(bench.pressure('main'))
        oil.append(amplitude / omega * math.sin(omega * h * (k + 1)))
    wave = np.exp(-1j * omega * h * np.arange(1, per_period + 1))
    last = slice(-per_period, None)
    return complex((np.array(oil[last]) * wave).sum() / (np.array(pressures[last]) * wave).sum())


@pytest.mark.parametrize('decade', [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0])
def test_it_goes_from_isothermal_to_adiabatic(decade: float) -> None:
    """C46 linearised: V/p (1 - (kappa - 1)/kappa j w kappa tau/(1 + j w kappa tau)), in 1 %."""
    omega = 10.0 ** decade / TAU
    p = 15e6 + ATMOSPHERE
    volume = 1e-3 * (10e6 + ATMOSPHERE) / p
    lag = 1j * omega * KAPPA * TAU
    expected = volume / p * (1.0 - (KAPPA - 1.0) / KAPPA * lag / (1.0 + lag)) + 1e-6 / 1.2e9
    assert abs(compliance(omega) / expected - 1.0) < 0.01
    if decade == -2.0:      # the two ends, four decades apart
        assert expected.real == pytest.approx(volume / p, rel=0.01, abs=0.0)
    if decade == 2.0:
        assert expected.real == pytest.approx(volume / (KAPPA * p), rel=0.01, abs=0.0)


def test_below_its_precharge_it_is_empty() -> None:
    """Only the oil of the manifold is left, of V/beta; the gas fills its shell."""
    bench = Bench(STANDS + BUFFER)
    bench.put('main', 8e6)
    main = bench.network.node('main')
    assert bench.state[main] == pytest.approx(1e-6 / 1.2e9 * 8e6, rel=1e-12, abs=0.0)
    bench.put('main', 12e6)
    volume = 1e-3 * (10e6 + ATMOSPHERE) / (12e6 + ATMOSPHERE)
    assert bench.state[main] == pytest.approx(
        1e-6 / 1.2e9 * 12e6 + 1e-3 - volume, rel=1e-9, abs=0.0)
    assert bench.pressure('main') == pytest.approx(12e6, rel=1e-9, abs=0.0)


def test_gas_that_is_lost_takes_its_oil_and_energy_along() -> None:
    """The pressure stays at that instant; from then on there is less to give."""
    circuit = circuit_of(SIMPLE + BUFFER, 'main')
    lost = circuit_of(SIMPLE + BUFFER.replace('}', ', gas_lost: 1.0}'), 'main')
    n = len(circuit._network.nodes)
    before, total = circuit.pressures, circuit.state[:n].sum()
    circuit.change(sheet_lost())
    assert circuit.pressures == [pytest.approx(before[0], rel=1e-9, abs=1e-3)]
    assert circuit.state[:n].sum() == pytest.approx(total, rel=1e-12, abs=0.0)
    assert circuit.state[0] > 4e-4      # l of oil that the shell keeps
    for one in (circuit, lost):
        one.advance_held([1e-6], [0.0])
    assert circuit.pressures[0][0] == pytest.approx(lost.pressures[0][0], rel=1e-6, abs=0.0)
    whole = circuit.samples[0]
    assert whole['pump_energy'] + whole['held_energy'] == pytest.approx(
        whole['energy'] + whole['relief_energy'] + whole['return_energy']
        + whole['stored_energy'], abs=1e-6 * abs(float(whole['stored_energy'])))


def sheet_lost():
    """Return the simple circuit without its gas."""
    from tests.surroundings.circuits.sheets import sheet_of
    return sheet_of(SIMPLE + BUFFER.replace('}', ', gas_lost: 1.0}'))
