"""A run file and a scenario simulated in this process, without messages and bag."""

from dataclasses import dataclass

from isa_ros.actuator import SmartActuator, Timing
from isa_ros.config import load_run
from isa_ros.load.leg_kernel import LEG_SAMPLE
from isa_ros.paths import CONFIG, find, SCENARIOS
from isa_ros.run_config import RunConfig
from isa_ros.scenario import load_scenario, Scenario
from isa_ros.shared_load import SharedLoad
from isa_ros.signals import COMMAND, LOAD_REPLY, SAMPLE
import numpy as np


@dataclass(frozen=True)
class Traces:
    """What a run shows at t = 0 and at the end of every tick."""

    run: RunConfig
    t: np.ndarray
    """s, (n_ticks + 1,)."""
    samples: np.ndarray
    """`SAMPLE` rows, (n_ticks + 1, n_actuators)."""
    leg: np.ndarray
    """`LEG_SAMPLE` rows, (n_ticks + 1,); zeros where there is no leg."""

    def of(self, name: str) -> np.ndarray:
        """Return the samples of one actuator, (n_ticks + 1,)."""
        return self.samples[:, self.run.index(name)]


def simulate(config: str, scenario: str) -> Traces:
    """Return the traces of a shipped run file with a shipped scenario."""
    run = load_run(find(config, CONFIG))
    return simulate_scenario(load_scenario(find(scenario, SCENARIOS), run))


def simulate_scenario(scenario: Scenario) -> Traces:
    """Return the traces of a scenario with its own run."""
    run, n = scenario.run, scenario.n_ticks
    shared = SharedLoad(run)
    timing = Timing(run.step_ns, run.controller_offset_ns)
    actuators = [SmartActuator(config, timing) for config in run.actuators]
    for actuator, start in zip(actuators, shared.starts(run)):
        actuator.start(*start.item())
    commands = np.zeros(len(actuators), COMMAND)
    replies = np.zeros(len(actuators), LOAD_REPLY)
    samples, leg = np.zeros((n + 1, len(actuators)), SAMPLE), np.zeros(n + 1, LEG_SAMPLE)

    def note(k: int) -> None:
        for j, actuator in enumerate(actuators):
            samples[k, j] = actuator.sample
        if shared._leg is not None:
            leg[k] = shared._leg.sample
    note(0)
    for tick in range(n):
        scenario.commands(tick, commands)
        ports = shared.ports()
        for j, actuator in enumerate(actuators):
            if commands['kinds'][j]:
                actuator.accept(commands[j])
            actuator.tick(ports[j])
            replies[j] = actuator.reply
        shared.advance(replies)
        note(tick + 1)
    return Traces(run, np.arange(n + 1) * run.step_ns * 1e-9, samples, leg)
