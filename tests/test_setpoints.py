"""Setpoints of several actuators as arrays: the same commands as by name, refused alike."""

from isa_ros.controller import Setpoint, Setpoints
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT
from isa_ros.errors import SetpointError
from isa_ros.requests import fill_requests
import numpy as np
import pytest

NAMES = ['haa', 'hfe', 'kfe']


def filled(setpoints) -> np.ndarray:
    rows = np.zeros(3, COMMAND)
    fill_requests(setpoints, NAMES, rows)
    return rows


@pytest.mark.parametrize('setpoints', [
    Setpoints(['kfe', 'haa'], [0.03, 0.2], [0.1, 0.2], [5.0, 6.0], [1e4, 2e4], [10.0, 20.0]),
    Setpoints(['kfe', 'haa'], np.array([0.03, 0.2]), effort=7.0, stiffness=0.0, damping=0.0),
    Setpoints(['hfe'], 0.03)])
def test_they_are_the_commands_by_name(setpoints):
    """What is not given: no speed, no effort, and the gains in force; others are untouched."""
    by_name = {name: setpoints.of(k) for k, name in enumerate(setpoints.names)}
    rows = filled(setpoints)
    assert rows.tobytes() == filled(by_name).tobytes()
    assert rows['kinds'][NAMES.index(setpoints.names[0])] == HAS_SETPOINT
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
    (Setpoints(['haa'], 'high'), "setpoint position = 'high', must be a number or 1 numbers")])
def test_refused(setpoints, message):
    with pytest.raises(SetpointError) as refused:
        filled(setpoints)
    assert message in str(refused.value)


def test_one_of_them():
    of = Setpoints(['haa', 'kfe'], [0.1, 0.2], effort=3.0).of(1)
    assert of == Setpoint(position=0.2, velocity=0.0, effort=3.0)
