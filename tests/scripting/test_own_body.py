"""A body of the caller: any object with the Protocol `Body`, moved by named actuators."""

from collections.abc import Mapping
from pathlib import Path
import re

import isa_ros
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.run.local_run import LocalRun
import numpy as np
import pytest

MASS, STIFFNESS = 40.0, 2e5     # kg, N/m
STEP = 1e-3                     # s
START = 0.04                    # m
RIG = {
    'name': 'slide', 'supply': {
        'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0,
        'return_line': {'kind': 'held'}},
    'body': {'kind': 'external', 'actuators': ['pull', 'push']},
    'actuators': {'push': {'model': 'isa_v5'}, 'pull': {'model': 'isa_v5'}}}


class Slide:
    """A mass on a spring between two cylinders: x'' = (F_0 + F_1 - k (x - x_0))/m."""

    def __init__(self, mounting: isa_ros.Mounting) -> None:
        self.rows, self.step = mounting.rows, mounting.step
        self.sample = np.zeros(1, [('position', '<f8'), ('velocity', '<f8')])
        self.sample['position'] = START
        self.forces: list[np.ndarray] = []

    @property
    def units(self) -> Mapping[str, str]:
        """Return m and m/s."""
        return {'position': 'm', 'velocity': 'm/s'}

    def starts(self, starts: np.ndarray) -> None:
        """Both pistons stand at the mass, without force."""
        starts['position'][self.rows], starts['force'][self.rows] = START, 0.0

    def ports(self, ports: np.ndarray) -> None:
        """Each sees the mass, its spring, and no force of the other."""
        x, v = self.sample[0]
        for row in self.rows:
            port = ports[row]
            port['x0'], port['v0'] = x, v
            port['a0'] = port['a_bias'] = -STIFFNESS / MASS * (x - START)
            port['inverse_mass'], port['jerk'], port['damping'] = 1.0 / MASS, 0.0, 0.0
            port['stiffness'] = STIFFNESS / MASS

    def advance(self, replies: np.ndarray) -> None:
        """Advance exactly: constant forces in each of five windows."""
        forces = replies['mean_forces'][self.rows]
        self.forces.append(forces.copy())
        self.sample[0] = moved(*self.sample[0], forces.sum(axis=0), self.step)

    def snapshot(self) -> bytes:
        """Return the sample, which is all."""
        return self.sample.tobytes()

    def restore(self, snapshot: bytes) -> None:
        """Take the sample."""
        self.sample[:] = np.frombuffer(snapshot, self.sample.dtype)


def moved(x: float, v: float, forces: np.ndarray, step: float) -> tuple[float, float]:
    """Return place and speed after windows of constant force, from the analytic solution."""
    w, h = np.sqrt(STIFFNESS / MASS), step / FORCE_WINDOWS
    for force in forces:
        rest = START + force / STIFFNESS
        away = x - rest
        x, v = (rest + away * np.cos(w * h) + v / w * np.sin(w * h),
                v * np.cos(w * h) - w * away * np.sin(w * h))
    return x, v


def rig(**changes: object) -> isa_ros.Run:
    """Return two cylinders on one mass."""
    tree = {key: value for key, value in (RIG | changes).items() if value is not None}
    return isa_ros.load(tree, {
        'name': 'push', 'duration_s': 0.05, 'tracks': {
            'push': [{'t_s': 0.0, 'position': START, 'effort': 500.0, 'stiffness': 1e5,
                      'damping': 1e3}],
            'pull': [{'t_s': 0.0, 'position': START, 'effort': 0.0, 'stiffness': 0.0,
                      'damping': 0.0}]}})


def test_a_body_of_the_caller_is_moved_by_the_forces_of_its_actuators() -> None:
    """
    Its own equation under the recorded mean forces gives the recorded motion.

    Both are the same sums: 1e-13 of 0.04 m and of 0.5 m/s. The actuators' rows are in the order of
    the run file's list, not in that of the actuators.
    """
    made: list[Slide] = []

    def factory(mounting: isa_ros.Mounting) -> Slide:
        assert mounting.names == ['pull', 'push'] and mounting.are_rotary == [False, False]
        assert mounting.positions.tolist() == [0.05, 0.05] and mounting.seed == 0
        made.append(Slide(mounting))
        return made[-1]
    result = rig().simulate(body=factory)
    slide, = made
    assert slide.rows.tolist() == [1, 0] and slide.step == STEP
    assert len(slide.forces) == len(result.time) - 1 == 50
    x, v = START, 0.0
    for tick, forces in enumerate(slide.forces, start=1):
        x, v = moved(x, v, forces.sum(axis=0), STEP)
        assert result['body.position'][tick] == pytest.approx(x, rel=0.0, abs=1e-14)
        assert result['body.velocity'][tick] == pytest.approx(v, rel=0.0, abs=1e-13)
    assert result.units['body.velocity'] == 'm/s'
    # Both pistons end at the mass; a load cell of 1e7 N/m and more gives way by 0.1 mm a kN.
    for name in ('push', 'pull'):
        assert result[f'{name}.position'][-1] == pytest.approx(x, abs=1e-4)
    assert result['body.position'][-1] > START + 1e-4


def test_every_simulation_has_a_body_of_its_own() -> None:
    """Also one with another seed; state and restored state go on alike."""
    simulation = rig().simulation(body=Slide)
    for _ in range(10):
        simulation.step()
    kept, first = simulation.snapshot(), simulation.body_sample.copy()
    assert simulation.body_samples['body'].position == first.position
    simulation.step()
    after = simulation.body_sample.copy()
    simulation.restore(kept)
    assert simulation.body_sample == first
    simulation.step()
    assert simulation.body_sample == after
    assert 'body.position' in rig().simulate(0.002, seed=3, body=Slide)
    simulation.reset(seed=3)
    assert simulation.body_sample.position == START and simulation.body_sample.velocity == 0.0


def test_two_bodies_of_the_caller_are_given_by_name() -> None:
    run = rig(body=None, bodies={
        'one': {'kind': 'external', 'actuators': ['push']},
        'two': {'kind': 'external', 'actuators': ['pull']}})
    result = run.simulate(0.002, body={'one': Slide, 'two': Slide})
    assert {'one.position', 'two.position'} <= set(result)
    assert 'body.position' not in result
    with pytest.raises(ConfigError, match='body is one factory, the run has 2 bodies'):
        run.simulate(0.002, body=Slide)
    with pytest.raises(ConfigError, match="'on' is not a body of the kind external; .*one"):
        run.simulate(0.002, body={'on': Slide})
    with pytest.raises(ConfigError, match='bodies.two is external and has no class'):
        run.simulate(0.002, body={'one': Slide})


def test_a_run_without_its_body_is_refused() -> None:
    with pytest.raises(ConfigError, match='body is external and has no class: only a run in Py'):
        LocalRun(rig().configuration)
    with pytest.raises(ConfigError, match='body is one factory, the run has 0 bodies'):
        isa_ros.load('leg').simulate(0.001, body=Slide)
    with pytest.raises(ConfigError, match='body: its factory returned a dict, must be an isa_ros'):
        rig().simulate(0.001, body=lambda mounting: {})


def test_a_factory_that_fails_or_gives_one_body_twice_is_named() -> None:
    def fails(mounting: isa_ros.Mounting) -> Slide:
        raise OSError('licence expired')
    with pytest.raises(ConfigError, match=r'^body: its factory: OSError: licence expired \(test_'):
        rig().simulate(0.001, body=fails)
    kept: list[Slide] = []

    def one(mounting: isa_ros.Mounting) -> Slide:
        kept.append(kept[0] if kept else Slide(mounting))
        return kept[0]
    rig().simulate(0.001, body=one)
    with pytest.raises(ConfigError, match='body: its factory returned the same Slide twice'):
        rig().simulate(0.001, body=one)


@pytest.mark.parametrize('place', [0.3, -0.001])
def test_a_start_outside_the_stroke_is_refused(place: float) -> None:
    class Far(Slide):
        """It starts beyond an end."""

        def starts(self, starts: np.ndarray) -> None:
            """Fill it."""
            starts['position'][self.rows] = place
    with pytest.raises(
            ConfigError, match=f'body: pull starts at {place} m, must be within its stroke'):
        rig().simulate(0.001, body=Far)


class Broken(Slide):
    """At its third tick a number that it gives is none, or it fails."""

    field, what, ticks = 'jerk', np.nan, 0

    def ports(self, ports: np.ndarray) -> None:
        """Fill them; a number of the second actuator is broken."""
        super().ports(ports)
        if self.ticks == 3 and self.field:
            ports[self.field][self.rows[1]] = self.what

    def advance(self, replies: np.ndarray) -> None:
        """Count."""
        super().advance(replies)
        self.ticks += 1
        if self.ticks == 3 and not self.field:
            self.sample['velocity'] = self.what


@pytest.mark.parametrize(('field', 'value', 'message'), [
    ('jerk', np.nan, r'^body.port_jerk\[1\] \(push\) = nan at t = 0.003000 s, must be finite'),
    ('x0', -np.inf, r'^body.port_x0\[1\] \(push\) = -inf at t = 0.003000 s'),
    ('', np.nan, '^body.velocity = nan at t = 0.003000 s')])
def test_a_number_that_is_none_is_named_as_the_bodys(
        field: str, value: float, message: str) -> None:
    """In the tick in which it is given, before an actuator has it."""
    kind = type('Own', (Broken,), {'field': field, 'what': value})
    with pytest.raises(SimulationDiverged, match=message):
        rig().simulate(body=kind)


@pytest.mark.parametrize('function', ['starts', 'ports', 'advance', 'snapshot', 'restore'])
def test_a_body_that_fails_is_named_with_its_place(function: str) -> None:
    def fails(*given: object) -> None:
        raise KeyError('no licence')
    with pytest.raises(RunError, match=rf"Own.{function}: KeyError: 'no licence' \(test_own_body"):
        rig().simulate(0.002, body=type('Own', (Slide,), {function: fails}))


def test_its_text_is_read_back() -> None:
    """The actuators in their order; the start is that of the actuators' own keys."""
    run = rig(actuators={
        'push': {'model': 'isa_v5', 'initial_position_mm': 40.0}, 'pull': {'model': 'isa_v5'}})
    config = run.configuration
    assert run_of_text(config.to_yaml()) == config
    assert [own.initial_position for own in config.actuators][0] == pytest.approx(0.04)
    assert config.body('body').joints == (('pull', 'pull'), ('push', 'push'))


@pytest.mark.parametrize(('changes', 'message'), [
    ({'body': {'kind': 'external', 'actuators': []}}, 'actuators is empty'),
    ({'body': {'kind': 'external', 'actuators': ['push', 'arm']}},
     "body.actuators = 'arm' is not an actuator"),
    ({'body': {'kind': 'external', 'actuators': ['push', 'push']}},
     "body.actuators has 'push' twice, must have it once"),
    ({'body': {'kind': 'internal', 'actuators': ['push']}}, 'must be one of leg, external'),
    ({'actuators': {'push': {'model': 'isa_v5', 'load': {'kind': 'locked'}},
                    'pull': {'model': 'isa_v5'}}},
     'push.load is not used: the actuator moves push of the external body, which gives its load'),
    ({'bodies': {'push': {'kind': 'external', 'actuators': ['push', 'pull']}}, 'body': None},
     "the name 'push' is taken"),
    ({'bodies': {'one': {'kind': 'external', 'actuators': ['push', 'pull']},
                 'two': {'kind': 'external', 'actuators': ['push']}}, 'body': None},
     'bodies.two.actuators = .push. already moves push of the external body one')])
def test_a_section_that_cannot_be_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        rig(**changes)


def test_the_program_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    """It prints place and force: the piston holds its start at mid stroke, 10 mm ahead."""
    page = (Path(__file__).parents[2] / 'docs' / 'bodies.md').read_text(encoding='utf-8')
    program = next(text for text in re.findall(r'```python\n(.*?)```', page, re.DOTALL)
                   if 'class Cart' in text)
    exec(program, {})
    place, force = map(float, capsys.readouterr().out.split())
    assert place == pytest.approx(0.05, abs=0.01) and abs(force) < 1e4
