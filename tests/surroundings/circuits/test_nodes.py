"""Nodes: content and pressure are inverse, missing oil is a cavity."""

from isa_ros.core.signals import LOAD_PORT
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.nodes import (
    node_capacity, node_content, node_energy, node_pressure, phase_of, temperature_with, VAPOUR)
import numpy as np
import pytest
from tests.surroundings.circuits.advanced import advance
from tests.surroundings.circuits.sheets import Bench, circuit_of, MS, sheet_of, SIMPLE, SLOPE
from tests.surroundings.circuits.station import surplus

BUFFER = 'buffer: {kind: accumulator, at: main, gas_volume_l: 1.0, precharge_mpa: 10.0}\n'
STANDS = SIMPLE.replace('1500.0, leakage_lpm_per_mpa: 0.1', '0.0')
C = 0.5e-3 / 1.2e9


def test_missing_oil_is_a_cavity_that_is_filled_again() -> None:
    """Drawn 20 ml of the 8.3 ml that are compressed in it, and given back: nothing is lost."""
    circuit = circuit_of(STANDS, 'main')
    start = circuit.pressures[0][0]
    for _ in range(100):
        advance(circuit, [2e-7], [0.0])
    assert circuit.pressures[0][0] == VAPOUR
    # the step in which the cavity opens errs by half a step's oil squared over C
    corner = 0.5 * (2e-7 / circuit._steps) ** 2 / C
    assert surplus(circuit) == pytest.approx(0.0, abs=2.0 * corner)
    assert corner < 1e-3 < 1e-2 < abs(VAPOUR) * 1.1e-5      # of the cavity of 11 ml
    for _ in range(100):
        advance(circuit, [-2e-7], [0.0])
    assert circuit.pressures[0][0] == pytest.approx(start, rel=1e-9, abs=0.0)
    assert surplus(circuit) == pytest.approx(0.0, abs=4.0 * corner)


@pytest.mark.parametrize('parts', [STANDS, STANDS + BUFFER])
@pytest.mark.parametrize('pressure', [0.0, 5e6, 9.99e6, 10.01e6, 30e6])
def test_content_and_pressure_are_inverse(parts: str, pressure: float) -> None:
    """C45 and C46, and the capacity is the slope of what a fast change needs."""
    bench = Bench(parts)
    bench.put('main', pressure)
    assert bench.pressure('main') == pytest.approx(pressure, rel=1e-9, abs=1e-3)


def test_capacity_is_the_slope_of_the_content_of_an_adiabatic_change() -> None:
    """By RK4 over a time in which no heat flows, within the difference's curvature."""
    bench = Bench(STANDS + BUFFER)
    bench.put('main', 15e6)
    main = bench.network.node('main')
    node, theta = bench.network.nodes[main], bench.state[bench.n + main]
    expected = float(node_capacity(15e6, theta, node))
    bench.drawn[main] = -1e-3
    bench.advance(100, 1e-7)
    slope = 1e-3 * 1e-5 / (bench.pressure('main') - 15e6)
    # the change is 1.7e-5 of the gas: the slope differs by half of that; heat is 1e-6
    assert slope == pytest.approx(expected, rel=1e-4, abs=0.0)


@pytest.mark.parametrize(('content', 'phase'), [
    (3e-4, 0), (1.001 * 10e6 * C, 0), (0.999 * 10e6 * C, 1), (1e-7, 1), (-1e-4, 2)])
def test_the_temperature_with_an_energy_is_its_inverse(content: float, phase: int) -> None:
    """On both sides of both corners of P, from 1 % beside it, also where that is another side."""
    bench = Bench(STANDS + BUFFER)
    main = bench.network.node('main')
    node, theta = bench.network.nodes[main], float(bench.state[bench.n + main])
    assert phase_of(content, theta, node) == phase
    energy = float(node_energy(content, theta, node))
    for beside in (0.99, 1.01):
        assert temperature_with(energy, content, beside * theta, node) == pytest.approx(
            theta, rel=1e-12, abs=0.0)


def test_energy_is_the_integral_of_the_pressure() -> None:
    """E10 of oil and of a gas without heat: P dD, from below to above the precharge."""
    bench = Bench(STANDS + BUFFER.replace('}', ', thermal_time_constant_s: 1.0e+4}'))
    bench.put('main', 9e6)
    main = bench.network.node('main')
    node = bench.network.nodes[main]

    def energy() -> float:
        return float(node_energy(bench.state[main], bench.state[bench.n + main], node))
    before, work = energy(), 0.0
    bench.drawn[main] = -1e-4
    for _ in range(4000):
        p = bench.pressure('main')
        bench.advance(1, 2e-4)
        work += 0.5 * (p + bench.pressure('main')) * 2e-8
    # trapezoids: the corner at the precharge costs C dP^2/4 at most, heat 4e-5 of the gas's
    assert energy() - before == pytest.approx(work, rel=2e-4)
    held = bench.network.nodes[bench.network.node('tank')]
    assert node_energy(1.0, 0.0, held) == 0.0 == node_pressure(1.0, 0.0, held)
    assert node_content(9e6, bench.state[bench.n + main], node) == pytest.approx(
        9e6 * C, rel=1e-9, abs=0.0)
    assert np.isfinite(bench.state).all()


def test_a_cavity_that_opens_costs_a_little_of_its_step() -> None:
    """
    E12 at a node without gas: `(q h)^2/(24 C)`, Simpson's error over a corner, and no more after.

    Over 60 flows, whose corners are at other places of their step; oil is kept to rounding.
    """
    c, shares = 0.05e-3 / 1.2e9, []
    for k in range(60):
        circuit = circuit_of(STANDS.replace('l: 0.5', 'l: 0.05'), 'main')
        tick = (3.0 + 0.37 * k) * 1e-6 / 60.0
        at_first, drawn = float(circuit.state[2]), 0.0
        while circuit.pressures[0][0] > VAPOUR:
            advance(circuit, [tick], [0.0])
            drawn += tick
        left, step = surplus(circuit), tick / circuit._steps
        shares.append(abs(left) / (step * step / c))
        for _ in range(5):
            advance(circuit, [tick], [0.0])
            drawn += tick
        assert surplus(circuit) == pytest.approx(left, abs=1e-9)
        assert at_first - circuit.state[2] == pytest.approx(drawn, rel=1e-12, abs=0.0)
    assert 0.04 < max(shares) <= 1.0 / 24.0 * (1.0 + 1e-6)


def test_actuators_have_the_return_pressure_of_their_tick_s_start() -> None:
    """It is held over a tick, whatever they return in it, and moves in the next."""
    text = SIMPLE.replace('oil_volume_l: 0.5', 'oil_volume_l: 0.5, returns_to: back') + (
        'back: {kind: manifold, oil_volume_l: 0.2}\n'
        'filter: {kind: filter, inlet: back, outlet: tank, lpm_per_mpa: 60.0}\n')
    circuit = Circuit(sheet_of(text), MS, [Fed('main', SLOPE, rows=(0,))])
    rows = np.zeros(1, LOAD_PORT)
    held = []
    for _ in range(3):
        circuit.filling.to(rows).run()
        held.append(float(rows['return_pressure'][0]))
        before = circuit.samples[0]['energy']
        advance(circuit, [0.0], [2e-7], [0.0])
        # it pays for what it returns with what it was given at the start
        assert circuit.samples[0]['energy'] - before == pytest.approx(
            -held[-1] * 2e-7, rel=1e-12, abs=1e-12)
    assert held[0] == 0.0 < held[1] < held[2]
    # 12 l/min through 60 l/min/MPa end at 0.2 MPa, with C/G = 0.17 ms
    assert held[1] == pytest.approx(0.2e6 * (1.0 - np.exp(-6.0)), rel=1e-3)
