"""Every shipped circuit under its scenario: oil and energy of the whole, by its own account."""

import warnings

from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.tick.trips import TripWarning
import pytest
from tests.surroundings.circuits.station import surplus

SECONDS = {'cooled_station': 1.0, 'crane_circuit': 3.0, 'pump_station': 1.6,
           'quadruped_power_unit': 1.0, 'warm_stand': 1.0}
"""What is run of the scenario of the same name: a station's emergency stop and what follows."""


def test_all_shipped_circuits_are_here() -> None:
    """By what their run files feed actuators from."""
    found = {path.stem for path in shipped(CONFIG).values() if any(
        isinstance(own.sheet, CircuitSupply) for own in load_run(path).supplies)}
    assert found == set(SECONDS)


def ended(name: str) -> tuple[Circuit, float]:
    """Return the circuit of a configuration at the end, and the oil that it had at the start."""
    simulation = Simulation(load(name, name).scenario)
    circuit, = simulation.surroundings._circuits
    at_first = oil_of(circuit)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', TripWarning)
        for _ in range(round(SECONDS[name] * 1e3)):
            simulation.step()
    return circuit, at_first


def oil_of(circuit: Circuit) -> float:
    """Return the oil of all nodes, tank and outside among them, and what actuators hold, m3."""
    whole = circuit.samples[0]
    contents = float(circuit.state[:len(circuit._network.nodes)].sum())
    return contents + float(whole['drawn'] - whole['returned'])


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=pytest.mark.slow) if name.startswith('quadruped') else name
    for name in SECONDS])
def test_oil_and_energy_close(name: str) -> None:
    """E12 within 1e-6 of what flowed, C45 within 1e-9 of the oil that did."""
    circuit, at_first = ended(name)
    whole = circuit.samples[0]
    oil = float(whole['drawn'] + whole['returned'])
    assert oil > 1e-5
    assert abs(oil_of(circuit) - at_first) < 1e-9 * oil
    energy = abs(float(whole['pump_energy'])) + abs(float(whole['energy']))
    assert energy > 500.0
    assert abs(surplus(circuit)) < 1e-6 * energy
