"""The commands of a measured machine, given to the simulated one."""

import isa_ros
from isa_ros.actuator.setpoint_range import LIMIT, SetpointRange
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.playback import playback, prepared, remark
from isa_ros.analysis.signals.signals import Signal
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.errors import ConfigError
import numpy as np
import pytest


@pytest.mark.parametrize('commands, changes, expected', [
    (('position_command', 'velocity_command'), {}, ''), (('force_command',), {}, ''),
    (('position_command', 'force_command'), {}, '40 ms'),
    (('position_command',), {'damping': 0.0}, ''),
    (('position_command',), {'stiffness': 0.0}, ''),
    (('position_command',), {'damping': 500.0}, 'damping over stiffness, 5 ms; map it, or add')])
def test_what_makes_a_simulation_late_is_told(
        commands: tuple[str, ...], changes: dict[str, float], expected: str) -> None:
    run = isa_ros.load('rig_linear', changes={
        f'actuators.ram.parameters.reu.position.{key}': value for key, value in changes.items()})
    signal = Signal(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    found = remark(run, 'ram', Measurement('press.csv', dict.fromkeys(commands, signal)))
    assert expected in found and bool(found) == bool(expected)


def test_a_position_loop_without_velocity_lacks_its_feed_forward() -> None:
    signal = Signal(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    own = Measurement('press.csv', {'position_command': signal})
    run = isa_ros.load('rig_rotary_position')
    name, = run.actuators
    key = f'actuators.{name}.parameters.reu.position.kv'
    assert remark(run.replace({key: 0.0}), name, own) == ''
    assert 'the feed-forward kv of the position loop has nothing' in remark(
        run.replace({key: 1e-3}), name, own)


def test_a_command_holds_until_the_next_and_the_first_before_it() -> None:
    """At t = 0 there is none: the machine stands at what was measured first."""
    run = isa_ros.load('rig_linear').configuration
    commands = {'position_command': Signal(np.array([0.5, 0.6]), np.array([0.01, 0.02]))}
    found = playback(run, 'ram', commands, 1000)
    assert [found.next_command(tick) for tick in (0, 1, 7)] == [1, 1, 7]
    rows = np.zeros((1000, 1), COMMAND)
    for tick, row in enumerate(rows):
        found.commands(tick, row)
    assert not rows['kinds'][0].any() and (rows['kinds'][1:] == HAS_SETPOINT).all()
    assert set(rows['position'][1:600, 0]) == {0.01} and set(rows['position'][600:, 0]) == {0.02}
    assert not rows['effort'].any() and np.isnan(rows['stiffness'][1:]).all()


@pytest.mark.parametrize('quantity, value, field, expected', [
    ('position_command', 9.0, 'position', 0.1), ('position_command', -9.0, 'position', 0.0),
    ('force_command', 1e6, 'effort', None), ('spool_command', -1.0, 'reference', None),
    ('current_command', 2.0, 'reference', None)])
def test_commands_beyond_the_range_are_limited(
        quantity: str, value: float, field: str, expected: float | None) -> None:
    """As the actuator itself limits them, those within stay."""
    run = isa_ros.load('rig_linear').configuration
    values = np.array([1e-6, value])
    found = playback(run, 'ram', {quantity: Signal(np.array([0.0, 0.5]), values)}, 600).received
    own = SetpointRange('ram', run.actuator('ram').sheet, LIMIT)
    row = found[550].copy()
    row[field] = value
    assert own.admit(row).startswith('ram: setpoint ')
    assert found[field][550] == row[field] != value and found[field][400] == 1e-6
    assert expected in (None, row[field])
    assert found['position'][400] == (1e-6 if field == 'position' else
                                      0.0 if field == 'reference' else 0.05)


@pytest.mark.parametrize('first', [-1e-3, 0.1001, 50.0])
def test_a_first_position_beyond_the_stroke_is_refused_by_its_mapping(first: float) -> None:
    """It is the mapping's unit, sign or offset: the run file is right."""
    own = Measurement('press.csv', {
        'position': Signal(np.array([0.0, 1.0]), np.array([first, 0.05])),
        'position_command': Signal(np.array([0.0]), np.array([0.05]))})
    with pytest.raises(ConfigError) as refused:
        prepared(isa_ros.load('rig_linear'), 'ram', own)
    assert str(refused.value) == (
        f'press.csv: position begins at {first:g} m, must be within 0 to 0.1 m, the stroke of '
        'ram: are its unit, sign and offset in the mapping right?')
