"""A controller that counts ticks, and what a simulation shows after each."""

from collections.abc import Mapping, Sequence
import struct

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.scenario.scenario import load_scenario, Scenario
from isa_ros.simulation import Simulation
from tests.runs import ACCUMULATOR, CONSTANT, hip_and_knee

RUN = hip_and_knee([SupplyConfig('constant', CONSTANT, ('hip',)),
                    SupplyConfig('pump', ACCUMULATOR, ('knee',))])


class Counter(Controller):
    """Asks one actuator for a place that counts the ticks since its start; a state of its own."""

    def __init__(self, name: str = 'knee', offset: float = 0.0) -> None:
        self.name, self.offset = name, offset
        self.count = 0
        self.shown: list[tuple[int, list[float], list[float]]] = []
        self.starts: list[list[str]] = []

    def start(self, names: Sequence[str]) -> None:
        self.count = 0
        self.starts.append(list(names))

    def step(self, state: State) -> Mapping[str, Setpoint]:
        self.shown.append((
            state.t_ns, [float(own.position) for own in state.actuators.values()],
            [float(own.pressure) for own in state.supplies.values()]))
        self.count += 1
        return {self.name: Setpoint(self.offset + 1e-4 * self.count)}

    def snapshot(self) -> bytes:
        return struct.pack('<q', self.count)

    def restore(self, snapshot: bytes) -> None:
        self.count, = struct.unpack('<q', snapshot)


def shows(simulation: Simulation) -> bytes:
    """Return everything that the simulation shows now."""
    body = b'' if simulation.body_sample is None else simulation.body_sample.tobytes()
    return b''.join([
        *(own.tobytes() for own in simulation.samples.values()),
        *(own.tobytes() for own in simulation.supply_samples.values()), body,
        simulation.applied.tobytes(), repr(simulation.tuned).encode()])


def stepped(simulation: Simulation, ticks: int) -> list[bytes]:
    """Return what the simulation shows after each of some ticks."""
    said = []
    for _ in range(ticks):
        simulation.step()
        said.append(shows(simulation))
    return said


def drop() -> Scenario:
    return load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG)))
