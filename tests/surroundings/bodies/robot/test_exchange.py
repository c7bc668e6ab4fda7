"""The exchange of a whole quadruped with its twelve actuators, against ticks of a tenth."""

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import isa_ros
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.config.paths import find
from isa_ros.core.accounts import SHARES
from isa_ros.core.signals import LOAD_PORT
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.port import matched
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np
import pytest
import yaml

DURATION = 0.3      # s: a fall of 5 cm takes 0.10 s
WINDOW = 0.2e-3     # s, of a tick of 1 ms a fifth
FINE = {'adc_bits': 24, 'encoder_resolution': 1e-9}
CLEAR_MS = 90.0     # until then all feet are in the air
START = {'height_mm': 50.0, 'roll_deg': 3.0, 'pitch_deg': 4.0}
LIGHT = {'mechanics': {'sensor_damping': 200.0}}    # a damping ratio of 0.01
RINGING = {'friction': {'stiction': 1.0, 'coulomb': 1.0, 'bristle_damping': 0.0, 'viscous': 0.0}}


class Drop(NamedTuple):
    """A tilted drop of a quadruped on its twelve actuators."""

    forces: np.ndarray
    """Mean force of every actuator in each `WINDOW`, N | Nm, (n, 12)."""
    lacking: float
    """Largest gap of the work that the actuators gave to that which the body took, J."""
    flow: float
    """Sum of all work that was exchanged, to and fro, J."""


def quadruped(folder: Path, step_ms: float, plant: dict[str, Any],
              start: dict[str, float] = START) -> isa_ros.Simulation:
    """
    Return a quadruped above the ground, tilted, with fine sensors and no controller.

    ``plant`` are values of its cylinders.
    """
    tree = yaml.safe_load(find('quadruped.yaml', 'config').read_text())
    tree |= {'step_ms': step_ms, 'controller_offset_ms': 0.08}
    tree.pop('controllers', None)
    for name, actuator in tree['actuators'].items():
        own = {} if name.endswith('haa') else plant
        actuator['parameters'] = {'plant': {'sensors': FINE, **own}}
    tree['body']['start'] |= start
    path = folder / f'drop_{step_ms}.yaml'
    path.write_text(json.dumps(tree))
    return isa_ros.load(path).simulation()


def drop(folder: Path, step_ms: float, is_light: bool, foresees: bool = False) -> Drop:
    """Return a drop; ``foresees``: the ports know the forces of their own tick."""
    simulation = quadruped(folder, step_ms, LIGHT if is_light else {})
    body, group = simulation.surroundings.bodies['body'], simulation.group
    means, given, taken = [], [], []
    for tick in range(round(DURATION / (step_ms * 1e-3))):
        if foresees and tick * step_ms > CLEAR_MS:
            foreseen_tick(simulation.surroundings, group, step_ms * 1e-3)
        elif foresees:
            one_tick(simulation.surroundings, group)
        else:
            simulation.step()
        means.append(group.replies['mean_forces'][body.rows].T.copy())
        given.append(group.samples['work'][body.rows].copy())
        taken.append(float(body.sample['drive_work'][0]))
    work, received = np.array(given), np.array(taken)
    gap = work.sum(axis=1) - received
    return Drop(np.concatenate(means).reshape(round(DURATION / WINDOW), -1, 12).mean(axis=1),
                float(np.abs(gap - gap[0]).max()), float(np.abs(np.diff(work, axis=0)).sum()))


def one_tick(surroundings: Surroundings, group: ActuatorGroup) -> np.ndarray:
    """Advance both sides by a tick, as a run does; return the ports."""
    ports = np.zeros(12, LOAD_PORT)
    surroundings.ports(ports)
    group.advance(ports)
    surroundings.advance(group.replies)
    return ports


def foreseen_tick(surroundings: Surroundings, group: ActuatorGroup, tick: float) -> None:
    """
    Advance by a tick twice: with ports as they are, and with such as foresee what it gave.

    L15 with the places and speeds at the end of the first try, and with the line through its mean
    forces instead of L32.
    """
    body = surroundings.bodies['body']
    before, actuators = body.snapshot(), group.snapshot()
    one_tick(surroundings, group)
    ends = body._arrays.drives[['position', 'velocity']].copy()
    forces = group.replies['mean_forces'][body.rows].copy()
    body.restore(before)
    group.restore(actuators)
    ports = np.zeros(12, LOAD_PORT)
    surroundings.ports(ports)
    middles = (np.arange(FORCE_WINDOWS) + 0.5) * tick / FORCE_WINDOWS
    for row, (place, speed), means in zip(body.rows, ends, forces):
        port = ports[row]
        slope, force = np.polyfit(middles, means, 1)
        a, b = matched(place - port['x0'] - tick * (port['v0'] + 0.5 * tick * port['a0']),
                       speed - port['v0'] - tick * port['a0'], tick, port['stiffness'],
                       port['damping'])
        port['a_bias'] = a + port['a0'] - force * port['inverse_mass']
        port['jerk'] = b - slope * port['inverse_mass']
    group.advance(ports)
    surroundings.advance(group.replies)


def errors(own: Drop, reference: Drop) -> np.ndarray:
    """Return the rms of the difference of each actuator's force over that of the force, (12,)."""
    found: np.ndarray = np.sqrt(np.square(own.forces - reference.forces).mean(axis=0)
                                / np.square(reference.forces).mean(axis=0))
    return found


@pytest.fixture(scope='module')
def references(tmp_path_factory: pytest.TempPathFactory) -> dict[bool, Drop]:
    """Return the drops with ticks of 0.1 ms by whether their load cells are light."""
    folder = tmp_path_factory.mktemp('references')
    found = {is_light: drop(folder, 0.1, is_light) for is_light in (False, True)}
    for own in found.values():
        assert own.forces.shape[1] == 12 and np.abs(own.forces).max() > 1500.0
    return found


@pytest.mark.slow
@pytest.mark.parametrize('is_light', [False, True])
def test_a_quadruped_lands_as_with_ticks_of_a_tenth(
        tmp_path: Path, references: dict[bool, Drop], is_light: bool) -> None:
    """
    Forces at every joint within 0.5 % rms, their peaks within 1 %, energy within 1.5e-5.

    The sensors are 4000 times as fine as the shipped ones: with those a fall from 1 um higher
    changes the small forces at HAA by 0.4 % already, by where the converters round.
    """
    reference, own = references[is_light], drop(tmp_path, 1.0, is_light)
    assert errors(own, reference).max() < 5e-3
    peaks = np.abs(own.forces).max(axis=0) / np.abs(reference.forces).max(axis=0) - 1.0
    assert np.abs(peaks).max() < 1e-2
    assert own.lacking < 1.5e-5 * own.flow


@pytest.mark.slow
@pytest.mark.parametrize('is_light', [False, True])
def test_half_a_tick_has_a_sixth_of_the_error_and_a_tenth_of_the_energy_that_does_not_close(
        tmp_path: Path, references: dict[bool, Drop], is_light: bool) -> None:
    """Below 0.05 % rms at every joint, and 1.5e-6 of the exchanged work, of 1.1e-5 at 1 ms."""
    own = drop(tmp_path, 0.5, is_light)
    assert own.flow > 200.0
    assert errors(own, references[is_light]).max() < 5e-4
    assert own.lacking < 1.5e-6 * own.flow


@pytest.mark.slow
def test_what_1_ms_gets_wrong_are_the_forces_that_the_look_ahead_assumes(
        tmp_path: Path, references: dict[bool, Drop]) -> None:
    """
    Ports of the same form that know the forces of their tick: 0.1 % rms, not 0.23 %.

    Neither linearisation nor windows are at fault, but L32: as a foot lands, the next tick's
    forces are no continuation of the last one's. Energy that does not close: 7e-6, not 1.1e-5.
    """
    own, foreseen = (drop(tmp_path, 1.0, True, foresees) for foresees in (False, True))
    assert errors(foreseen, references[True]).max() < 1.2e-3 < errors(own, references[True]).max()
    assert errors(foreseen, references[True])[7] < 0.2 * errors(own, references[True])[7]
    assert 0.9e-5 < own.lacking / own.flow < 1.5e-5
    assert foreseen.lacking < 0.75 * own.lacking


@pytest.mark.slow
@pytest.mark.parametrize('stiffness', [7e7, 1e8])
def test_the_ringing_of_light_cells_dies_out_where_it_beats_with_the_ticks(
        tmp_path: Path, stiffness: float) -> None:
    """
    A damping ratio of 0.001, hardly any friction: standing after a fall of 5 mm, for 1 s.

    By what a force in a window differs from the line through its neighbours. With the line
    through the forces themselves (no moving mass in L32) the first grows 1e4 times within 0.4 s,
    and the run with the second ends by values that are not finite.
    """
    simulation = quadruped(tmp_path, 1.0, RINGING | {'mechanics': {
        'sensor_stiffness': stiffness, 'sensor_damping': 2e-3 * math.sqrt(0.6 * stiffness)}},
        {'height_mm': 5.0, 'roll_deg': 2.0, 'pitch_deg': 1.0})
    rows = simulation.surroundings.bodies['body'].rows
    swings = []
    for _ in range(1000):
        simulation.step()
        means = simulation.group.replies['mean_forces'][rows]
        swings.append(np.square(np.diff(means, 2, axis=1)).max())
    early, late = (math.sqrt(np.mean(own)) for own in (swings[:200], swings[-200:]))
    assert early > 50.0
    assert late < 0.02 * early


def test_energy_closes_over_oil_actuators_trunk_and_ground() -> None:
    """
    Within 1e-6 of what went through, while the robot sinks on its feet.

    What the actuators give to their loads (E2) is what the links receive, though each integrates
    its own copy of the other over a tick; the robot's account (L30) and the oil's shares close.
    """
    result = isa_ros.load('quadruped.yaml').simulate(0.3)

    def total(*names: str) -> np.ndarray:
        return np.sum([result[f'body.{name}'] for name in names], axis=0)
    actuators = [name.removesuffix('.work') for name in result.keys() if name.endswith('.work')]
    shares = [entry.field for entry in SHARES]
    oil = sum(result[f'{name}.hydraulic_energy'] for name in actuators)
    spent = sum(result[f'{name}.{share}'] for name in actuators for share in shares)
    given = sum(result[f'{name}.work'] for name in actuators)
    whole = total('kinetic_energy', 'potential_energy', 'elastic_energy', 'ground_loss')
    through = abs(oil[-1]) + total('ground_loss')[-1]
    assert len(actuators) == 12 and through > 500.0 and abs(given[-1]) > 50.0
    assert np.abs(oil - spent).max() < 1e-6 * through
    assert np.abs(given - total('drive_work')).max() < 1e-6 * np.abs(given).max()
    assert np.ptp(whole - total('drive_work', 'push_work')) < 1e-6 * np.abs(given).max()
