"""
The quadruped at work, in numbers and pictures: the tables and the figure of docs/quadruped.md.

It stands, squats, is pushed and trots at several speeds; pose and forces are read from its bag.
The energy is balanced over trunk and ground, and over what the actuators exchange with them.

    python scripts/measure_quadruped.py [FIGURE.png]
"""

from collections.abc import Sequence
from pathlib import Path
import sys
from tempfile import TemporaryDirectory

from isa_ros.analysis.signals.recorded_result import read
from isa_ros.examples.quadruped.legs import Legs
from isa_ros.examples.quadruped.trot import rotation
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
from isa_ros.text.table import aligned
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

CONFIG = 'quadruped'
PROGRAM = 'scenario.controllers.trot.program[3].speed'
SPEEDS = (0.0, 0.25, 0.5, 0.75, 1.0)    # m/s
STEADY = 3.0                            # s, from which on the mean speed is taken
PICTURES = (0.3, 5.88, 6.02, 6.17, 6.32, 6.47, 6.61, 6.76)     # s: quarters of a stride
FRONT, BACK, HALF = 0.55, -0.55, 0.125      # m, of the trunk's box


def main(arguments: Sequence[str]) -> None:
    """Print both tables and draw the strip."""
    rows: list[Sequence[str]] = [(
        'scenario', 'height, m', 'roll, rad', 'pitch, rad', 'speed, m/s', 'oil, l/min',
        'peak force, kN', 'trunk and ground', 'actuators to body')]
    for name in ('stand', 'squat', 'jolt'):
        rows.append(row(name, simulated(f'quadruped_{name}')))
    for speed in SPEEDS:
        result = simulated('quadruped_trot', speed)
        rows.append(row(f'trot at {speed:g} m/s', result))
        if speed == 0.5:
            draw(result, Path(arguments[0] if arguments else 'docs/figures/quadruped.png'))
    print('\n'.join(aligned(rows, 'lrrrrrrrr')))


def simulated(scenario: str, speed: float | None = None) -> Result:
    """Return a run of a scenario."""
    return load(CONFIG, scenario, changes={} if speed is None else {PROGRAM: speed}).simulate()


def row(name: str, result: Result) -> Sequence[str]:
    """Return what is shown of a run."""
    with TemporaryDirectory() as folder:
        recorded = read(result.save(Path(folder) / 'bag'))
    place, time = recorded['body.position'], recorded.time
    w, x, y, z = recorded['body.orientation'].T
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(2.0 * (w * y - z * x))
    late = time >= min(STEADY, 0.5 * time[-1])
    speed = (place[-1, 0] - place[late][0, 0]) / (time[-1] - time[late][0])
    actuators = [own.name for own in result.scenario.run.actuators]
    linear = [own for own in actuators if not own.endswith('haa')]
    oil = sum(result[f'{own}.supply_volume'][-1] for own in actuators) / time[-1] * 6e4
    force = max(np.abs(recorded[f'{own}.force']).max() for own in linear)
    return (name, f'{place[:, 2].min():.3f}', f'{np.abs(roll).max():.3f}',
            f'{np.abs(pitch).max():.3f}', f'{speed:.3f}', f'{oil:.1f}', f'{1e-3 * force:.1f}',
            *(f'{part:.1e}' for part in balances(result, actuators)))


def balances(result: Result, actuators: Sequence[str]) -> tuple[float, float]:
    """
    Return what does not close, over the throughput of each balance.

    Of the body: kinetic, potential and elastic energy and what ground and soles took, less the
    work of the actuators and of the push. Between both: the work that the actuators gave off
    less that which the body took.
    """
    kept, taken = (sum(result[f'body.{name}'] for name in names) for names in (
        ('kinetic_energy', 'potential_energy', 'elastic_energy', 'ground_loss'),
        ('drive_work', 'push_work')))
    body = kept - taken
    given = sum(result[f'{own}.work'] for own in actuators)
    flow = sum(np.abs(np.diff(result[f'{own}.work'])).sum() for own in actuators)
    lacking = (given - given[0]) - (result['body.drive_work'] - result['body.drive_work'][0])
    return float(np.abs(body - body[0]).max() / flow), float(np.abs(lacking).max() / flow)


def draw(result: Result, path: Path) -> None:
    """Draw the robot from the side and from the front at some instants."""
    legs = Legs(result.scenario.run.body('body').sheet)     # type: ignore[union-attr]
    figure = Figure(figsize=(10.0, 2.5), layout='constrained')
    views = figure.subplots(2, len(PICTURES), sharey='row')
    for k, t in enumerate(PICTURES):
        for ax, (across, sign) in zip(views[:, k], ((0, 1.0), (1, -1.0))):
            picture(ax, result, legs, round(t / result.time[1]), across, sign)
        views[0, k].set_title(f'{t:g} s', fontsize=9)
    views[0, 0].set_ylabel('from the right')
    views[1, 0].set_ylabel('from behind')
    figure.savefig(path, dpi=110)
    print(path)


def picture(
        ax: Axes, result: Result, legs: Legs, k: int, across: int, sign: float) -> None:
    """Draw one instant against a horizontal axis of the world."""
    root, place = rotation(result['body.orientation'][k]), result['body.position'][k]
    names = [joint.name for joint in result.scenario.run.body('body').sheet.joints]  # type: ignore
    legs.update(root, np.zeros(3), np.array(
        [result[f'body.{name}_position'][k] for name in names]), np.zeros(len(names)))
    width = 0.175
    corners = np.array([[x, y, z] for x, y, z in (
        (FRONT, width, HALF), (FRONT, width, -HALF), (BACK, width, -HALF), (BACK, width, HALF),
        (FRONT, width, HALF), (FRONT, -width, HALF), (FRONT, -width, -HALF), (BACK, -width, -HALF),
        (BACK, -width, HALF), (FRONT, -width, HALF))]) @ root.T
    ax.plot(sign * corners[:, across], corners[:, 2] + place[2], color='0.6', linewidth=1.0)
    for foot, contact, path in zip(legs.feet, legs.feet_of, legs.paths):
        points = np.array([*legs.origins[path], foot])
        stands = result[f'body.{contact.name}_touches'][k] > 0.0
        ax.plot(sign * points[:, across], points[:, 2] + place[2], 'o-', markersize=2.0,
                linewidth=1.8, color='C0' if stands else 'C1')
    ax.axhline(0.0, color='k', linewidth=0.8)
    ax.set_aspect('equal')
    ax.set_xlim(-0.75, 0.75) if across == 0 else ax.set_xlim(-0.5, 0.5)
    ax.set_ylim(-0.05, 0.8)
    ax.set_xticks([])
    ax.tick_params(labelsize=7)


if __name__ == '__main__':
    main(sys.argv[1:])
