"""What a tick with an external body costs, by its parts."""

import isa_ros
from isa_ros.bench import door
from isa_ros.bench.groups import GROUPS
import numpy as np
import pytest


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(door, 'REPEATS', 3)


def test_the_parts_of_a_tick_are_measured_in_both() -> None:
    """A tick is more than the actuators in it, and a port more than the motions in it."""
    pytest.importorskip('mujoco', reason='no wheel for this Python')
    group, = [group for group in GROUPS if group.name == 'door']
    found = {row.name: row.number for row in group.rows({})}
    assert all(value > 0.0 for name, value in found.items() if name != 'of it not covered')
    rows = group.rows({})
    left = [row for row in rows if row.most_share is not None]
    assert [row.part_of for row in left] == [
        'masses in numpy: a whole tick', 'crane in MuJoCo: a whole tick, look-ahead']
    of_masses = {row.name: row.number for row in rows[:4]}
    whole = of_masses.pop('masses in numpy: a whole tick')
    assert left[0].value == pytest.approx(whole - sum(of_masses.values()), abs=1e-9)
    crane = {name.partition(': ')[2]: value for name, value in found.items()
             if name.startswith('crane in MuJoCo: ')}
    assert crane['a whole tick, look-ahead'] > crane['three actuators']
    assert crane['a port, full'] > crane['a port, look-ahead'] > crane['motion, of a new state']
    assert crane['motion, of a new state'] > crane['mj_forward']
    assert found['masses in numpy: a whole tick'] > found['masses in numpy: a port']


def test_without_mujoco_the_masses_are_measured_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(door, 'find_spec', lambda name: None)
    *masses, crane = door.door_rows()
    assert [row.name for row in masses] == [
        'masses in numpy: a port', 'masses in numpy: advance of the body',
        'masses in numpy: three actuators', 'masses in numpy: a whole tick', 'of it not covered']
    assert crane.value is None and 'needs MuJoCo' in crane.note


def test_the_masses_swing_on_their_springs() -> None:
    """Under a constant force about F/k, with the period 2 pi sqrt(m/k), 0.2 s."""
    mounting = isa_ros.Mounting(['a'], np.arange(1), np.array([0.1]), [False], 1e-3, 0)
    masses = door.Masses(mounting)
    state, places = masses.state, []
    for _ in range(199):
        state = masses.stepped(state, np.full((5, 1), 1000.0), 1e-3)
        places.append(masses.motion(state, np.zeros(1)).position[0] - 0.1)
    assert max(places) == pytest.approx(2.0 * 1000.0 / 1e5, rel=1e-2)
    assert int(np.argmax(places)) + 1 == pytest.approx(99, abs=1)
    assert abs(places[-1]) < 1e-4
