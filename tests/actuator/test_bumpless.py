"""Changes of mode and of gains while it moves: the current of the valve does not jump."""

from itertools import permutations

from isa_ros.controller import Setpoint
from isa_ros.core.device import DISABLED, IMPEDANCE, MODES, QUICK_STOP
from isa_ros.core.signals import COMMAND
from isa_ros.requests import fill_command
from isa_ros.reu.wiring import possible_modes
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override, setpoint, smart_actuator

WIRINGS = [(), ('explicit',), ('pressure_control',), ('feedback_linearisation',),
           ('position_control',)]
LOADS = {'smart_manifold': 'wheel', 'isa_v2': 'mass', 'isa_v5': 'mass'}
SETTLED, MOVING = 300, 60    # ticks of 0.1 ms, one conversion each
ROUNDING = 1e-15             # A; currents are at most 0.1 A, of which this is a few bits
SHARE = 0.05                 # of the stroke: the step that it moves by


def moving(model, variants=(), mode=None, **device):
    """Return an actuator in a mode, which is on its way to another position."""
    sheet = actuator_sheet(model, 'default', *variants)
    for name, value in device.items():
        sheet = override(sheet, f'reu.device.{name}', value)
    actuator = smart_actuator(model, LOADS[model], sheet=sheet)
    if mode is not None:
        actuator.change_mode(MODES[mode])
    else:
        actuator.accept(setpoint(position=(0.5 + SHARE) * sheet.plant.drive.stroke))
    currents(actuator, SETTLED)
    return actuator


def currents(actuator, ticks):
    """Return the current's references of some conversions, amplifier A."""
    found = []
    for _ in range(ticks):
        actuator.tick()
        found.append(float(actuator.sample.current_reference))
    return np.array(found)


def jump(actuator, change):
    """Return how far the current goes in the period of a change, A."""
    before = currents(actuator, MOVING)[-1]
    change(actuator)
    return abs(currents(actuator, 1)[0] - before)


@pytest.mark.parametrize('variants', WIRINGS)
@pytest.mark.parametrize('model', MODELS)
def test_the_current_does_not_jump_between_any_two_modes(model, variants):
    """From the outermost mode while it moves inwards, and back; the new mode is in force."""
    modes = possible_modes(actuator_sheet(model, 'default', *variants).reu)
    for first, second in permutations(modes, 2):
        actuator = moving(model, variants)
        if first != modes[-1]:
            assert jump(actuator, lambda own: own.change_mode(MODES[first])) < ROUNDING
            currents(actuator, MOVING)
        assert jump(actuator, lambda own: own.change_mode(MODES[second])) < ROUNDING
        assert actuator.sample.device_mode == second


CHANGES = {
    'kp': lambda own: own.tune({'force.kp': 0.3 * own.parameter('force.kp')}),
    'stiffness': lambda own: own.tune(
        {'position.stiffness': 0.3 * own.parameter('position.stiffness')}),
    'force': lambda own: own.change_mode('force'),
    'spool': lambda own: own.change_mode('spool')}


@pytest.mark.parametrize('late', [1, 2, 5, 8])
@pytest.mark.parametrize('change', CHANGES)
def test_the_current_does_not_jump_when_a_block_runs_later_than_the_change(change, late):
    """Not at the next conversion, nor where a slower block runs first; in between it moves."""
    actuator = moving('isa_v5')
    before = currents(actuator, MOVING + late)[-1]
    CHANGES[change](actuator)
    jumps = abs(np.diff(currents(actuator, 12), prepend=before))
    inner, outer = -late % 2, -late % 10     # 5 kHz and 1 kHz at conversions of 10 kHz
    first_runs = {0, inner} | ({outer} if actuator.sample.device_mode == IMPEDANCE else set())
    assert jumps[sorted(first_runs)].max() < ROUNDING
    if change != 'spool':   # there the current is constant
        assert jumps[sorted({inner + 2, inner + 4} - first_runs)].min() > 1e3 * ROUNDING


def test_without_the_fade_the_same_changes_jump():
    """With a time constant far below a period the jump is there one period later."""
    def force(own):
        own.accept(setpoint(effort=2000.0))
        own.change_mode('force')
    steps = []
    for fade_ms in (5.0, 1e-3):
        actuator = moving('isa_v5', fade_ms=fade_ms)
        currents(actuator, MOVING)
        force(actuator)
        steps.append(abs(np.diff(currents(actuator, 3))).max())
    assert steps[0] < 0.1 * steps[1]
    assert steps[1] > 1e-4


@pytest.mark.parametrize('name', ['force.kp', 'force.kv', 'position.stiffness'])
def test_the_current_does_not_jump_with_a_gain(name):
    actuator = moving('isa_v5')
    value = actuator.parameter(name)
    assert jump(actuator, lambda own: own.tune({name: 0.3 * value})) < ROUNDING
    assert actuator.parameter(name) == 0.3 * value


def test_what_is_left_of_a_jump_fades_with_its_time_constant():
    """A share e^-1 after 5 ms, nothing once it is below a nanoampere."""
    actuator = moving('isa_v5')
    actuator.tune({'force.kp': 0.3 * actuator.parameter('force.kp')})
    currents(actuator, 1)
    fade = actuator.memory.reu['status']['fade'][0]
    first = float(fade['added'])
    assert abs(first) > 1e-6
    currents(actuator, 50)
    assert float(fade['added']) == pytest.approx(
        first * np.exp(-1.0), rel=1e-12, abs=0.0)  # 50 products round to 50 eps = 1e-14
    currents(actuator, 1000)
    assert (float(fade['added']), int(fade['is_on'])) == (0.0, 0)


@pytest.mark.parametrize('mode', ['force', 'spool', 'current'])
def test_back_in_impedance_it_stays_where_it_is_and_keeps_its_force(mode):
    """Without a setpoint of its own a mode starts with the references in force."""
    actuator = moving('isa_v5')
    actuator.change_mode(mode)
    currents(actuator, MOVING)
    actuator.change_mode('impedance')
    currents(actuator, 1)
    own = actuator.memory.reu[0]
    assert own['status']['mode'] == IMPEDANCE
    assert own['setpoint']['position'] == pytest.approx(actuator.sample.position, abs=1e-4)


def test_a_setpoint_that_comes_with_the_mode_is_taken():
    actuator = moving('isa_v5')
    actuator.accept(setpoint(position=0.05, effort=321.0))
    actuator.change_mode('force')
    currents(actuator, 1)
    assert actuator.sample.force_reference == 321.0


def test_a_stop_brings_the_load_to_rest_without_a_jump_and_ends_disabled():
    """50 kg at its speed, braked at 10 m/s2; it stands for 200 ms before it ends."""
    actuator = moving('isa_v5')
    command = np.zeros(1, COMMAND)[0]
    fill_command('isa_v5', Setpoint(quick_stop=True), command)
    assert jump(actuator, lambda own: own.accept(command)) < ROUNDING
    assert actuator.sample.device_state == QUICK_STOP
    speed = abs(float(actuator.sample.velocity))
    assert speed > 0.05
    currents(actuator, round(speed / 10.0 / 1e-4) + 1900)
    assert abs(float(actuator.sample.velocity)) < 0.05 * speed
    assert actuator.sample.device_state == QUICK_STOP
    currents(actuator, 700)
    assert actuator.sample.device_state == DISABLED


def test_a_jump_that_fades_ends_where_the_actuator_is_disabled():
    """Enabled again it begins with the current of its setpoint, not with what was left."""
    actuator = moving('isa_v5')
    actuator.tune({'force.kp': 0.3 * actuator.parameter('force.kp')})
    currents(actuator, 1)
    fade = actuator.memory.reu['status']['fade'][0]
    assert fade['is_on'] and abs(float(fade['added'])) > 1e-6
    command = np.zeros(1, COMMAND)[0]
    fill_command('isa_v5', Setpoint(is_enabled=False), command)
    actuator.accept(command)
    currents(actuator, 2)
    assert actuator.sample.device_state == DISABLED
    assert (int(fade['is_on']), int(fade['begins'])) == (0, 0)
