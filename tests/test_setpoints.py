"""Setpoints of several actuators as arrays: the same commands as by name, refused alike."""

from isa_ros.controller import Setpoint, Setpoints
from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, POSITION, PRESSURE, SPOOL
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_GAINS, HAS_SETPOINT, SAMPLE
from isa_ros.errors import SetpointError
from isa_ros.requests import fill_requests
import numpy as np
import pytest

NAMES = ['haa', 'hfe', 'kfe']


def filled(setpoints, samples=None) -> np.ndarray:
    rows = np.zeros(3, COMMAND)
    fill_requests(setpoints, NAMES, rows, samples)
    return rows


def samples_in(**modes: int) -> dict[str, np.record]:
    """Return the samples at 0.04, 0.05, 0.06 m; a mode that is not given is 0."""
    rows = np.zeros(3, SAMPLE).view(np.recarray)
    for k, name in enumerate(NAMES):
        rows[k].position, rows[k].device_mode = 0.04 + 0.01 * k, modes.get(name, 0)
    return dict(zip(NAMES, rows))


@pytest.mark.parametrize('setpoints', [
    Setpoints(['kfe', 'haa'], [0.03, 0.2], [0.1, 0.2], [5.0, 6.0], [1e4, 2e4], [10.0, 20.0]),
    Setpoints(['kfe', 'haa'], np.array([0.03, 0.2]), effort=7.0, stiffness=0.0, damping=0.0),
    Setpoints(['hfe'], 0.03), Setpoints(['hfe'], 0.03, velocity=None, effort=None),
    Setpoints(['hfe', 'kfe'], None, stiffness=1e4, damping=[10.0, 20.0])])
def test_they_are_the_commands_by_name(setpoints):
    """What is not given: no speed, no effort, and the gains in force; others are untouched."""
    by_name = {name: setpoints.of(k) for k, name in enumerate(setpoints.names)}
    rows = filled(setpoints)
    assert rows.tobytes() == filled(by_name).tobytes()
    assert rows['kinds'][NAMES.index(setpoints.names[0])] == (
        HAS_GAINS if setpoints.position is None else HAS_SETPOINT)
    assert rows['kinds'][1 if 'haa' in setpoints.names else 0] == 0


@pytest.mark.parametrize('setpoints', [
    Setpoints(['hfe'], 0.03), {'hfe': Setpoint(0.03)}], ids=['as arrays', 'by name'])
def test_a_setpoint_replaces_what_was_asked_of_its_actuator_before(setpoints):
    """It does not enable what an earlier request would have; the others keep theirs."""
    rows = np.zeros(3, COMMAND)
    rows['kinds'] = HAS_ENABLE
    fill_requests(setpoints, NAMES, rows)
    assert rows['kinds'].tolist() == [HAS_ENABLE, HAS_SETPOINT, HAS_ENABLE]
    assert rows['position'][1] == 0.03


@pytest.mark.parametrize('setpoints, message', [
    (Setpoints(['haa', 'knee'], 0.0), "'knee' is not an actuator of the run"),
    (Setpoints(['haa', 'kfe'], [0.0, np.nan]), 'kfe: setpoint position = nan, must be finite'),
    (Setpoints(['haa', 'kfe'], 0.0, effort=[np.inf, 0.0]), 'haa: setpoint effort = inf'),
    (Setpoints(['haa', 'kfe'], 0.0, stiffness=[1.0, -1.0]),
     'kfe: setpoint stiffness = -1.0, must be >= 0'),
    (Setpoints(['haa', 'kfe'], 0.0, damping=np.nan), 'haa: setpoint damping = nan'),
    (Setpoints(['haa', 'kfe'], [0.0, 0.0, 0.0]), 'setpoint position = [0.0, 0.0, 0.0], must be '
     'a number or 2 numbers'),
    (Setpoints(['haa'], 'high'), "setpoint position = 'high', must be a number or 1 numbers"),
    (Setpoints(['haa'], None, velocity=0.1), 'haa: setpoint velocity = 0.1 needs its position'),
    (Setpoints([['haa']], 0.1), "[['haa']] are no names of actuators"),
    (Setpoints(None, 0.1), 'None are no names of actuators')])
def test_refused(setpoints, message):
    with pytest.raises(SetpointError) as refused:
        filled(setpoints)
    assert message in str(refused.value)


def test_one_of_them():
    of = Setpoints(['haa', 'kfe'], [0.1, 0.2], effort=3.0).of(1)
    assert of == Setpoint(position=0.2, velocity=None, effort=3.0)


@pytest.mark.parametrize('mode', [CURRENT, SPOOL, PRESSURE, FORCE])
def test_without_an_effort_it_is_refused_in_the_modes_that_use_it(mode):
    """As by name: else a controller of positions would command no force, and the load falls."""
    with pytest.raises(SetpointError, match='kfe: setpoint position = 0.2 needs its'):
        filled(Setpoints(['haa', 'kfe'], [0.1, 0.2]), samples_in(haa=IMPEDANCE, kfe=mode))
    rows = filled(Setpoints(['haa', 'kfe'], [0.1, 0.2], effort=[3.0, 4.0]), samples_in(kfe=mode))
    assert rows['effort'].tolist() == [3.0, 0.0, 4.0]


@pytest.mark.parametrize('mode', [IMPEDANCE, POSITION])
def test_without_an_effort_it_is_0_in_the_modes_of_a_position(mode):
    """Also where an actuator that is not commanded is in another mode."""
    rows = filled(Setpoints(['haa', 'kfe'], [0.1, 0.2]), samples_in(haa=mode, kfe=mode, hfe=FORCE))
    assert rows['position'].tolist() == [0.1, 0.0, 0.2]
    assert rows['effort'].tolist() == rows['velocity'].tolist() == [0.0, 0.0, 0.0]


def test_an_effort_needs_no_position_in_the_mode_of_the_force():
    """It is the present one, as by name."""
    given = Setpoints(['kfe', 'hfe'], None, effort=[30.0, 40.0])
    samples = samples_in(hfe=FORCE, kfe=FORCE)
    rows = filled(given, samples)
    assert rows['kinds'].tolist() == [0, HAS_SETPOINT, HAS_SETPOINT]
    assert rows['effort'].tolist() == [0.0, 40.0, 30.0]
    assert rows['position'].tolist() == [0.0, samples['hfe'].position, samples['kfe'].position]
    with pytest.raises(SetpointError, match='kfe: setpoint effort = 30 needs its position'):
        filled(given, samples_in(hfe=FORCE, kfe=IMPEDANCE))
