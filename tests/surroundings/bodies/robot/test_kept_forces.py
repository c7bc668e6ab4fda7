"""How a robot continues the forces of its actuators into the next tick  (L32)."""

import math
from typing import NamedTuple

import isa_ros
from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.bodies.robot import kept_forces
from isa_ros.surroundings.bodies.robot.kept_forces import FIELDS, kept_part, rigid_line
from isa_ros.surroundings.bodies.robot.records import DRIVE
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sheet import MovingPart, RobotStart
from isa_ros.surroundings.port import window_line
import numpy as np
import pytest
from tests.surroundings.bodies.robot.test_reach import boom

TICK = 1e-3                     # s
WINDOW = TICK / FORCE_WINDOWS
STEPS = 4000                    # of a tick's ODE
MASS, LOAD = 0.6, 3.0           # kg
PUSH, PUSH_SLOPE = 900.0, 4e4   # N, N/s, behind the moving part
PULL, PULL_SLOPE = -200.0, 9e4  # N, N/s, on the load
AMPLITUDE = 300.0               # N, of the ringing


class Tick(NamedTuple):
    """A tick of two masses with a load cell between them: arguments of `rigid_line`."""

    means: np.ndarray
    forces: tuple[float, float]
    stretches: tuple[float, float]
    rates: tuple[float, float]


def ringing(stiffness: float, damping: float, play: float) -> Tick:
    """Integrate m s'' = P - F, M x'' = f + F, F = k phi(e) + d e', by RK4 from a ringing cell."""
    def force(e: float, rate: float) -> float:
        own = e - play * math.tanh(e / play) if play > 0.0 else e
        return stiffness * own + damping * rate

    def slopes(t: float, y: np.ndarray) -> np.ndarray:
        e, rate, _ = y
        own = force(e, rate)
        return np.array([rate, (PUSH + PUSH_SLOPE * t - own) / MASS
                         - (PULL + PULL_SLOPE * t + own) / LOAD, own])
    y, h, windows = np.array([(PUSH + AMPLITUDE) / stiffness + play, 0.0, 0.0]), TICK / STEPS, []
    ends = [y]
    for i in range(STEPS):
        k_1 = slopes(i * h, y)
        k_2 = slopes((i + 0.5) * h, y + 0.5 * h * k_1)
        k_3 = slopes((i + 0.5) * h, y + 0.5 * h * k_2)
        y = y + h / 6.0 * (k_1 + 2.0 * (k_2 + k_3) + slopes((i + 1) * h, y + h * k_3))
        if (i + 1) % (STEPS // FORCE_WINDOWS) == 0:
            windows.append(y[2])
    ends.append(y)
    return Tick(np.diff([0.0, *windows]) / WINDOW, tuple(force(*end[:2]) for end in ends),
                tuple(end[0] for end in ends), tuple(end[1] for end in ends))


@pytest.mark.parametrize(('stiffness', 'damping', 'play'), [
    (5e7, 0.0, 0.0), (5e7, 200.0, 0.0), (2e7, 50.0, 0.0), (3e7, 5e3, 0.0), (3e7, 0.0, 2e-6)])
def test_the_ringing_of_a_load_cell_is_not_in_the_line(
        stiffness: float, damping: float, play: float) -> None:
    """
    Two masses under forces that grow evenly: the line is that of a rigid cell.

    Q = mu (P/m - f/M) exactly. Of cos(w t) a window has (1 - z cot(z))/w^2 of its growth as first
    moment, z = w h/2, of which L32 takes z^2/3: the rest, of at most 2 A, is left in the slope.
    Damping and play make it less.
    """
    tick = ringing(stiffness, damping, play)
    mass = 1.0 / (1.0 / MASS + 1.0 / LOAD)
    mean, slope = rigid_line(TICK, *tick, mass)
    rigid = mass * (PUSH_SLOPE / MASS - PULL_SLOPE / LOAD)
    middle = mass * (PUSH / MASS - PULL / LOAD) + 0.5 * TICK * rigid
    swing = abs(tick.forces[0] - middle) + 10.0
    z = 0.5 * WINDOW * math.sqrt(stiffness / mass)
    most = 12.0 / TICK**3 * 2.0 * swing * mass / stiffness * (1.0 - z / math.tan(z) - z * z / 3.0)
    assert mean == pytest.approx(middle, rel=1e-6)
    assert slope == pytest.approx(rigid, abs=most)
    _, rise, _ = window_line(tick.means)
    if damping < 1e3:
        assert abs(rise / WINDOW - rigid) > 10.0 * abs(slope - rigid)


def test_without_a_moving_mass_it_is_the_line_of_least_squares() -> None:
    """Of the force itself, c t^2 + b t: slope b + c H at the middle, exactly."""
    b, c, starts = -3e4, 5e7, WINDOW * np.arange(FORCE_WINDOWS + 1)
    impulses = b * starts**2 / 2.0 + c * starts**3 / 3.0
    mean, slope = rigid_line(TICK, np.diff(impulses) / WINDOW, (0.0, b * TICK + c * TICK**2),
                             (9.0, -9.0), (5.0, 7.0), 0.0)
    assert mean == pytest.approx(impulses[-1] / TICK, rel=1e-12)
    assert slope == pytest.approx(b + c * TICK, rel=1e-12)


def kept_tick(k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (state, rows, drives, replies) of k actuators, all different."""
    random, rows = np.random.default_rng(k), np.arange(2 * k - 1, 0, -2)
    drives, replies = rows_of(k, DRIVE), rows_of(2 * k + 1, LOAD_REPLY)
    for name, bound in (('position', 1e-3), ('velocity', 0.1), ('moving_mass', 1.0),
                        ('inverse_mass', 1.0)):
        drives[name] = random.uniform(0.1 * bound, bound, k)
    for name, bound in (('position', 1e-3), ('velocity', 0.1), ('force', 1e3)):
        replies[name] = random.uniform(-bound, bound, 2 * k + 1)
    replies['mean_forces'] = random.uniform(-1e3, 1e3, (2 * k + 1, FORCE_WINDOWS))
    return random.uniform(-1e-3, 1e-3, 4 + FIELDS * k), rows, drives, replies


@pytest.mark.parametrize('k', (1, 2, 5))
def test_each_actuator_keeps_its_own_line(k: int) -> None:
    """At the tick's end, with the mass 1/(1/m + 1/m_eff), and the stretch s - x from there on."""
    state, rows, drives, replies = kept_tick(k)
    before = state.copy()
    kept, old = kept_part(state, k), kept_part(before, k)
    kept_forces.keep_rigid_forces(kept, TICK, rows, drives, replies)
    for j, row in enumerate(rows):
        reply, drive = replies[row], drives[j]
        mass = 1.0 / (1.0 / drive['moving_mass'] + drive['inverse_mass'])
        stretch = reply['position'] - drive['position']
        rate = reply['velocity'] - drive['velocity']
        mean, slope = rigid_line(
            TICK, reply['mean_forces'], (old.last_force[j], reply['force']),
            (old.stretch[j], stretch), (old.stretch_rate[j], rate), mass)
        assert kept.slope[j] == pytest.approx(slope, rel=1e-12)
        assert kept.force[j] == pytest.approx(mean + 0.5 * TICK * slope, rel=1e-9)
        assert (kept.last_force[j], kept.stretch[j], kept.stretch_rate[j]) == (
            reply['force'], stretch, rate)
    assert (state[:3] == before[:3]).all() and state[-1] == before[-1]


def test_the_compiled_kernel_equals_its_python_source() -> None:
    """Bit for bit."""
    found = []
    for keep in (kept_forces.keep_rigid_forces, kept_forces.keep_rigid_forces.py_func):
        state, rows, drives, replies = kept_tick(3)
        keep(kept_part(state, 3), TICK, rows, drives.view(np.recarray),
             replies.view(np.recarray))
        found.append(state.tobytes())
    assert found[0] == found[1]


def test_a_robot_at_rest_assumes_the_forces_that_hold_it() -> None:
    """From the first tick on: its cells are stretched by force over stiffness at t = 0."""
    part = MovingPart(mass=0.6, cell_stiffness=5e7)
    robot = Robot(boom(1), RobotStart(joints=(0.0,)), 1_000_000, moving=[part])
    [hold] = robot.actuator_forces
    ports, replies = np.zeros(1, LOAD_PORT), np.zeros(1, LOAD_REPLY)
    robot.ports(ports)
    replies['mean_forces'], replies['force'] = hold, hold
    replies['position'] = ports['x0'] + hold / part.cell_stiffness
    before = ports.copy()
    robot.advance(replies)
    robot.ports(ports)
    kept = kept_part(robot._state, 1)
    assert abs(hold) > 100.0
    assert kept.force[0] == pytest.approx(hold, rel=1e-9)
    assert abs(kept.slope[0]) * TICK < 1e-9 * abs(hold)
    assert ports['a_bias'] == pytest.approx(before['a_bias'], rel=1e-6)


def test_a_run_gives_its_robot_the_moving_parts_of_its_actuators() -> None:
    """Mass of the sheet, stretch of its cell at t = 0, and 1/m_eff of each port."""
    run = isa_ros.load('two_joint_leg.yaml')
    body = run.simulation().surroundings.bodies['body']
    sheets = [run.configuration.actuators[row].sheet.plant.mechanics for row in body.rows]
    drives, kept = body._arrays.drives, kept_part(body._state, len(body.rows))
    assert drives['moving_mass'].tolist() == [own.inertia for own in sheets]
    assert kept.last_force.tolist() == body.actuator_forces.tolist()
    assert kept.stretch.tolist() == [
        force / own.sensor_stiffness for force, own in zip(body.actuator_forces, sheets)]
    ports = np.zeros(len(run.configuration.actuators), LOAD_PORT)
    body.ports(ports)
    assert drives['inverse_mass'].tolist() == ports['inverse_mass'][body.rows].tolist()


def test_a_robot_continues_the_line_of_its_last_tick() -> None:
    """Without moving mass: forces that grew evenly by 80 N go on from where they ended."""
    robot, replies = Robot(boom(1), RobotStart(joints=(0.0,)), 1_000_000), np.zeros(1, LOAD_REPLY)
    [hold] = robot.actuator_forces
    replies['mean_forces'] = hold + 80.0 * (np.arange(FORCE_WINDOWS) + 0.5) / FORCE_WINDOWS
    replies['force'] = hold + 80.0
    robot.advance(replies)
    kept = kept_part(robot._state, 1)
    assert kept.slope[0] == pytest.approx(80.0 / TICK, rel=1e-9)
    assert kept.force[0] == pytest.approx(hold + 80.0, rel=1e-12)
