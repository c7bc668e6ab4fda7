"""
How exactly an impact of a leg is computed, by ground and macro step.

A leg falls 10 cm with its actuators. Its ground force is followed through every tick, since an
impact on metal lasts two ticks of 1 ms; it is compared with that of ticks of 0.2 ms, whose leg is
integrated in steps of 40 us (with ticks of 0.1 ms the peaks are the same to 0.05 %). Four
heights, a quarter of a millisecond of fall apart, put the impact at different places in a tick.
The table of docs/impacts.md:

    python scripts/measure_impacts.py
"""

from collections.abc import Sequence
import sys

from isa_ros.config.paths import find, SCENARIOS
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import COMMAND, LOAD_PORT
from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
from isa_ros.surroundings.bodies.leg.leg import Leg
from isa_ros.surroundings.bodies.leg.motion import continuous, leg_motion, LEG_STATE, leg_step
from isa_ros.surroundings.bodies.leg.port_kernel import mean_forces
from isa_ros.surroundings.bodies.leg.sheet import leg_record
import numpy as np

CONFIG = 'leg'
GROUNDS = ('rubber', 'wood', 'metal')
STEPS_MS = (1.0, 0.5)
FINE_MS = 0.2
RELEASE_S = 0.02
END_S = 0.25                # 80 ms after the impact
FALL_M = 0.1
# 1.4 m/s at the impact: a quarter of a millisecond of fall apart.
HEIGHTS = tuple(FALL_M + k * 0.25e-3 * 1.4 for k in range(4))
TRACED_NS = 10_000          # between the instants whose ground force is compared
TIME_BYTES = 8              # a snapshot begins with the time


@frozen
class Peaks:
    """The largest values of one drop, N."""

    ground: float
    """Of the normal force, at any instant."""
    ticks: float
    """Of the normal force at the ticks' ends, as messages and results have it."""
    knee: float
    """Of the knee's mean forces in a fifth of a tick."""


@kernel
def largest_normal_force(states, step_ns, rows, legs, replies):
    """Return the largest normal force in the tick that begins with ``states``, N."""
    state, leg = states[0], legs[0]
    y, is_held, largest = continuous(state), state.is_held != 0.0, 0.0
    substeps = step_ns // FORCE_WINDOWS // TRACED_NS
    for window in range(FORCE_WINDOWS):
        f = mean_forces(replies, rows, window)
        for _ in range(substeps):
            y = leg_step(y, TRACED_NS / NS_PER_SECOND, f, is_held, leg)
            largest = max(largest, leg_motion(y, f, is_held, leg).foot_force[2])
    return largest


def simulation(ground: str, step_ms: float, height: float) -> Simulation:
    """Return the drop from ``height`` (m) on a packaged ground."""
    scenario: Tree = {**read(find('drop', SCENARIOS)), 'leg': {
        'foot_height_mm': 1e3 * height, 'release_s': RELEASE_S}}
    run = load(CONFIG, scenario).replace({'leg.ground': ground, 'step_ms': step_ms})
    return Simulation(run.scenario)


def peaks(ground: str, step_ms: float, height: float) -> Peaks:
    """Return the `Peaks` of a drop."""
    drop = simulation(ground, step_ms, height)
    run, (body,) = drop.scenario.run, drop.surroundings.bodies.values()
    assert isinstance(body, Leg) and run.leg is not None
    legs, knee = leg_record(run.leg.sheet), body.rows[-1]
    ports, commands = (np.zeros(len(run.actuators), kind) for kind in (LOAD_PORT, COMMAND))
    found = Peaks(0.0, 0.0, 0.0)
    for tick in range(round(END_S * NS_PER_SECOND / run.step_ns)):
        commands['kinds'] = 0
        if drop.scenario.has_commands_at(tick):
            drop.scenario.commands(tick, commands)
        drop.surroundings.ports(ports)
        replies = drop.group.advance(ports, commands)
        before = np.frombuffer(body.snapshot(), LEG_STATE, 1, TIME_BYTES).copy()
        inside = largest_normal_force(
            before.view(np.recarray), run.step_ns, body.rows, legs, replies)
        drop.surroundings.advance(replies)
        found = Peaks(
            max(found.ground, inside), max(found.ticks, float(body.sample['foot_force'][0, 2])),
            max(found.knee, float(np.abs(replies['mean_forces'][knee]).max())))
    return found


def errors(ground: str, heights: Sequence[float] = HEIGHTS) -> dict[float, Peaks]:
    """Return the largest errors by macro step (ms), as shares of the peaks of fine ticks."""
    fine = [peaks(ground, FINE_MS, height) for height in heights]
    worst = {}
    for step_ms in STEPS_MS:
        coarse = [peaks(ground, step_ms, height) for height in heights]
        worst[step_ms] = Peaks(
            max(abs(c.ground / f.ground - 1.0) for c, f in zip(coarse, fine)),
            max(abs(c.ticks / f.ground - 1.0) for c, f in zip(coarse, fine)),
            max(abs(c.knee / f.knee - 1.0) for c, f in zip(coarse, fine)))
    return worst


def table() -> str:
    """Return the errors of every ground and macro step as the table of docs/impacts.md."""
    rows = ['| ground | tick, ms | ground force, % | sampled by ticks, % | knee, % |',
            '|---|---:|---:|---:|---:|']
    for ground in GROUNDS:
        for step_ms, found in errors(ground).items():
            shares = (found.ground, found.ticks, found.knee)
            rows.append(f'| {ground} | {step_ms:g} | '
                        + ' | '.join(f'{100.0 * share:.1f}' for share in shares) + ' |')
    return '\n'.join(rows)


if __name__ == '__main__':
    sys.stdout.write(table() + '\n')
