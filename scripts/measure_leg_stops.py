"""The standing, squatting and landing leg, all of whose actuators stop at the same time."""

from collections.abc import Callable, Mapping
from typing import Any

from isa_ros.simulation import Simulation
import numpy as np
from scripts.measure_stops import memory_of, simulation_of

LEGS = ('haa', 'hfe', 'kfe')
LEG_GAINS = {name: ({'stiffness': 300.0, 'damping': 10.0} if name == 'haa' else
                    {'stiffness': 1e5, 'damping': 4e3}) for name in LEGS}


def trunk(simulation: Simulation, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Advance; return the trunk's height (m) and the vertical force on the foot (N), (n,) each."""
    heights, forces = [], []
    for _ in range(round(seconds * 1e9 / simulation.scenario.run.step_ns)):
        simulation.step()
        own: Any = simulation.body_sample
        heights.append(float(own.height))
        forces.append(float(own.foot_force[-1]))
    return np.array(heights), np.array(forces)


def placed(shares: Mapping[str, float], seconds: float,
           changes: Mapping[str, Any] | None = None) -> tuple[Simulation, float]:
    """Return the leg after its joints have moved by speeds in m/s, and the trunk's speed."""
    simulation = simulation_of('leg', changes)
    starts = {name: float(simulation.samples[name].position) for name in LEGS}
    for name in LEGS:
        simulation.command(name, position=starts[name], **LEG_GAINS[name],
                           effort=float(simulation.samples[name].force))
    trunk(simulation, 1.0)
    efforts = {name: float(memory_of(simulation, name).reu['setpoint']['effort'][0])
               for name in LEGS}
    begin = simulation.t
    while (after := simulation.t - begin) < seconds:
        for name, speed in shares.items():
            simulation.command(name, position=starts[name] + speed * after, velocity=speed,
                               effort=efforts[name])
        simulation.step()
    return simulation, float(simulation.body_sample.height_velocity)  # type: ignore[union-attr]


def _standing() -> tuple[Simulation, float]:
    return placed({}, 0.0)


def _squatting() -> tuple[Simulation, float]:
    return placed({'kfe': -0.02, 'hfe': 0.016}, 0.15)


def _landing() -> tuple[Simulation, float]:
    """Return the leg 16 ms after the impact of a drop by 10 cm."""
    simulation = simulation_of('leg', {'leg.start.foot_height_mm': 100.0})
    for name in LEGS:
        simulation.command(name, position=float(simulation.samples[name].position),
                           **LEG_GAINS[name])
    while simulation.body_sample.foot_force[-1] <= 0.0:  # type: ignore[union-attr]
        simulation.step()
    trunk(simulation, 0.016)
    return simulation, float(simulation.body_sample.height_velocity)  # type: ignore[union-attr]


LEG_SITUATIONS: Mapping[str, Callable[[], tuple[Simulation, float]]] = {
    'stands': _standing, 'squats': _squatting, 'lands, from 10 cm': _landing}
