"""A leg whose actuators all stop, lose their setpoints, or are disabled and enabled."""

from isa_ros.simulation import Simulation
import numpy as np
import pytest
from scripts.measure_stops import simulation_of

LEGS = ('haa', 'hfe', 'kfe')
GAINS = {'haa': {'stiffness': 300.0, 'damping': 10.0},
         'linear': {'stiffness': 1e5, 'damping': 4e3}}


def standing(**values: float) -> Simulation:
    """Return the leg at rest on its foot, with 0.7 kN in its knee; values of its REUs by key."""
    simulation = simulation_of('leg', {
        f'actuators.{name}.parameters.reu.{key}': value
        for name in LEGS for key, value in values.items()})
    for name in LEGS:
        simulation.command(name, position=float(simulation.samples[name].position),
                           effort=float(simulation.samples[name].force),
                           **GAINS['haa' if name == 'haa' else 'linear'])
    heights(simulation, 1.0)
    assert simulation.samples['kfe'].force == pytest.approx(730.0, abs=30.0)
    return simulation


def heights(simulation: Simulation, seconds: float) -> np.ndarray:
    """Advance; return the height of the trunk at the end of each tick of 1 ms."""
    found = []
    for _ in range(round(seconds * 1e3)):
        simulation.step()
        found.append(float(simulation.body_sample.height))  # type: ignore[union-attr]
    return np.array(found)


def test_the_trunk_of_a_standing_leg_stays_where_it_is_when_all_stop() -> None:
    """It fell by 83 mm in 200 ms while a stop took the effort of the setpoint."""
    simulation = standing()
    height = heights(simulation, 0.001)[0]
    for name in LEGS:
        simulation.command(name, quick_stop=True)
    assert abs(heights(simulation, 0.25) - height).max() < 1e-3


def test_a_leg_stands_while_its_setpoints_are_lost_and_after_they_are_back() -> None:
    """
    It fell by 93 mm, and was thrown up by 61 mm afterwards.

    On the way back the joints share the weight anew, some 50 N on 1e5 N/m: 4 mm at the trunk.
    """
    simulation = standing(**{'protection.setpoint_timeout_ms': 1010.0})
    height = heights(simulation, 0.012)[-1]
    assert abs(heights(simulation, 0.3) - height).max() < 1e-3
    assert all(simulation.samples[name].trips for name in LEGS)
    rows = {name: simulation.samples[name] for name in LEGS}
    for name in LEGS:
        setpoint = simulation.group.actuators[simulation.names.index(name)].memory.reu['setpoint']
        simulation.command(name, position=float(setpoint['position'][0]),
                           effort=float(setpoint['effort'][0]))
    assert abs(heights(simulation, 0.2) - height).max() < 5e-3
    assert not any(row.trips for row in rows.values())


def test_a_leg_that_was_disabled_stands_again_when_it_is_enabled() -> None:
    """It sinks with the leakage of the valves; it fell by 95 mm after it was enabled."""
    simulation = standing()
    height = heights(simulation, 0.001)[0]
    for name in LEGS:
        simulation.command(name, is_enabled=False)
    sunk = heights(simulation, 0.3)
    for name in LEGS:
        simulation.command(name, is_enabled=True)
    assert abs(heights(simulation, 0.3) - sunk[-1]).max() < 1e-3
    assert abs(sunk - height).max() < 1.5e-3
