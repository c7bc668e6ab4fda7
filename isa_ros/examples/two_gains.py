"""
The force step of one actuator with two gains, overlaid: `python -m isa_ros.examples.two_gains`.

The figure goes to two_gains.png, or to the file named as argument.
"""

from collections.abc import Sequence
import sys
from typing import Any

import isa_ros
from matplotlib.figure import Figure

STEP = 750.0    # N, a tenth of the rating
KP = 'actuators.ram.parameters.reu.force.kp'
GAINS = (8e-8, 4e-8)    # m of spool per N: the shipped gain, and half of it
SCENARIO: dict[str, Any] = {
    'name': 'force_step', 'duration_s': 0.15, 'loads': {'ram': {'kind': 'blocked'}},
    'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold', 'stiffness': 0.0, 'damping': 0.0},
        {'t_s': 0.05, 'position': 'hold', 'effort': STEP}]}}


def results() -> dict[str, isa_ros.Result]:
    """Return the step with each gain."""
    run = isa_ros.load('rig_linear', SCENARIO)
    return {f'kp = {gain:g}': run.replace({KP: gain}).simulate() for gain in GAINS}


def main(arguments: Sequence[str]) -> None:
    """Simulate both and draw them."""
    figure = Figure(figsize=(6.0, 3.5), layout='constrained')
    ax = figure.subplots()
    for label, result in results().items():
        ax.plot(1e3 * result.time, result['ram.force'], label=label)
    ax.plot(1e3 * result.time, result['ram.force_reference'], 'k--', label='reference')
    ax.set_xlabel('time, ms')
    ax.set_ylabel(f'force, {result.units["ram.force"]}')
    ax.legend()
    path = arguments[0] if arguments else 'two_gains.png'
    figure.savefig(path)
    print(path)


if __name__ == '__main__':
    main(sys.argv[1:])
