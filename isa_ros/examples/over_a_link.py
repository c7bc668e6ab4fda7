"""
The stiffest impedance that a controller behind a link can hold, over the delay of the link.

    python -m isa_ros.examples.over_a_link

The controller is the impedance of the REU, computed by the commander from the samples that it
receives, and sent as effort: a position step of 1 mm of a mass of 50 kg, damping ratio 0.7.
"""

from collections.abc import Mapping, Sequence
import math
from typing import Any

import isa_ros
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.text.table import aligned
import numpy as np

MASS, DAMPING_RATIO = 50.0, 0.7
START, STEP = 0.05, 1e-3    # m
STIFFNESSES = [1e3 * 10.0 ** (k / 4.0) for k in range(17)]   # N/m, 1e3 to 1e7
DURATION, LATE = 1.5, 0.2   # s; the step has settled if it stays near the end of the run
SETTLED = 0.1               # of the step
DELAYS = (0, 1, 2, 4, 8)    # cycles of 1 ms; 0: no link

RUN: dict[str, Any] = {
    'name': 'ram', 'step_ms': 1.0, 'controller_offset_ms': 0.12, 'tick_timeout_s': 5.0,
    'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
    'actuators': {'ram': {
        'model': 'isa_v5', 'load': {'kind': 'mass'}, 'initial_position_mm': START * 1e3}}}


class Own(Controller):
    """The impedance of the REU itself."""

    def __init__(self, stiffness: float) -> None:
        self.stiffness = stiffness
        self.damping = 2.0 * DAMPING_RATIO * math.sqrt(stiffness * MASS)

    def step(self, state: State) -> Mapping[str, Setpoint]:
        return {'ram': Setpoint(
            START + STEP, stiffness=self.stiffness, damping=self.damping)}


class Remote(Own):
    """The same impedance in the commander; stiffness and damping of the REU are 0."""

    def step(self, state: State) -> Mapping[str, Setpoint]:
        ram = state.actuators['ram']
        effort = self.stiffness * (START + STEP - ram.position) - self.damping * ram.velocity
        return {'ram': Setpoint(START, effort=effort, stiffness=0.0, damping=0.0)}


def settles(controller: Controller, delay_cycles: int) -> bool:
    """Return whether the step settles with a link of so many cycles of 1 ms each way."""
    run = isa_ros.load(RUN)
    if delay_cycles:
        run = run.replace({
            'link': {'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': delay_cycles}})
    result = run.simulate(duration=DURATION, controllers=[controller])
    late = result['ram.position'][result.time > DURATION - LATE]
    return bool(np.ptp(late) < SETTLED * STEP)


def stiffest(impedance: type[Own], delay_cycles: int) -> float:
    """Return the largest of `STIFFNESSES` up to which every one settles, N/m; 0: none."""
    largest = 0.0
    for stiffness in STIFFNESSES:
        if not settles(impedance(stiffness), delay_cycles):
            break
        largest = stiffness
    return largest


def main() -> None:
    """Print the stiffest impedance for each delay."""
    rows: list[Sequence[str]] = [
        ('delay each way, ms', 'stiffest in the commander, N/m', 'in the REU, N/m')]
    rows += [(f'{delay}', *(f'{stiffest(impedance, delay):.3g}' for impedance in (Remote, Own)))
             for delay in DELAYS]
    print('\n'.join(aligned(rows, 'r')))


if __name__ == '__main__':
    main()
