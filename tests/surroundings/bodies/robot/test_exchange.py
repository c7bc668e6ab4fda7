"""The exchange of a whole quadruped with its twelve actuators, against ticks of a tenth."""

import json
from pathlib import Path

import isa_ros
from isa_ros.config.paths import find
from isa_ros.core.accounts import SHARES
import numpy as np
import pytest
import yaml

DURATION = 0.3      # s: a fall of 5 cm takes 0.10 s
WINDOW = 0.2e-3     # s, of a tick of 1 ms a fifth
FINE = {'adc_bits': 24, 'encoder_resolution': 1e-9}
LIGHT = {'mechanics': {'sensor_damping': 200.0}}    # a damping ratio of 0.01


def drop(folder: Path, step_ms: float, is_light: bool) -> np.ndarray:
    """Return the mean force of every actuator in each `WINDOW` of a tilted drop, (n, 12)."""
    tree = yaml.safe_load(find('quadruped.yaml', 'config').read_text())
    tree |= {'step_ms': step_ms, 'controller_offset_ms': 0.08}
    tree.pop('controllers', None)
    for name, actuator in tree['actuators'].items():
        light = LIGHT if is_light and not name.endswith('haa') else {}
        actuator['parameters'] = {'plant': {'sensors': FINE, **light}}
    tree['body']['start'] |= {'height_mm': 50.0, 'roll_deg': 3.0, 'pitch_deg': 4.0}
    path = folder / f'drop_{step_ms}.yaml'
    path.write_text(json.dumps(tree))
    simulation, means = isa_ros.load(path).simulation(), []
    rows = simulation.surroundings.bodies['body'].rows
    for _ in range(round(DURATION / (step_ms * 1e-3))):
        simulation.step()
        means.append(simulation.group.replies['mean_forces'][rows].T.copy())
    return np.concatenate(means).reshape(round(DURATION / WINDOW), -1, 12).mean(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize(('is_light', 'most'), [(False, 5e-3), (True, 7e-3)])
def test_a_quadruped_lands_as_with_ticks_of_a_tenth(
        tmp_path: Path, is_light: bool, most: float) -> None:
    """
    Forces at every joint within 0.5 % rms, their peaks within 1 %.

    With load cells of a damping ratio of 0.01 all but one are below 0.35 %; one hip of a hind leg
    has 0.6 %, and 1.1 % in its peak. The sensors are 4000 times as fine as the shipped ones: with
    those a fall from 1 um higher changes the small forces at HAA by 0.4 % already, by where the
    converters round.
    """
    reference, own = (drop(tmp_path, step_ms, is_light) for step_ms in (0.1, 1.0))
    assert reference.shape[1] == 12 and np.abs(reference).max() > 1500.0
    rms = np.sqrt(np.square(own - reference).mean(axis=0) / np.square(reference).mean(axis=0))
    assert rms.max() < most and np.sort(rms)[-2] < 5e-3
    peaks = np.abs(own).max(axis=0) / np.abs(reference).max(axis=0) - 1.0
    assert np.abs(peaks).max() < 2.0 * most


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
