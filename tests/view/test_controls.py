"""Sliders and faults of the actuators of a run: what they may be set to, and what they do."""

import isa_ros
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.core.changing_values import OVER
from isa_ros.core.signals import LOAD_PORT
from isa_ros.errors import ConfigError
from isa_ros.view.controls import Controls
from isa_ros.view.orders import Order
import numpy as np
import pytest


class Rig:
    """The actuators of a run at t = 0, and what a page may change of them."""

    def __init__(self, config, **changes):
        run = isa_ros.load(config, **changes).configuration
        self.surroundings, self.group = surroundings_of(run), group_of(run)
        self.group.start(self.surroundings.starts())
        self.controls = Controls(run, self.group, self.surroundings)
        self.tree = self.controls.tree()

    def order(self, what, of, name, value=None):
        return self.controls.carry_out(Order(what, of, name, value))

    def sliders(self, k=0):
        own = self.tree['actuators'][k]
        return {slider['name']: slider for slider in (*own['setpoints'], *own['gains'])}

    def tick(self):
        """Return the only actuator after one tick."""
        ports = np.zeros(len(self.group.actuators), LOAD_PORT)
        self.surroundings.ports(ports)
        self.group.advance(ports)
        return self.group.actuators[0]


@pytest.mark.parametrize('config', [
    'leg', 'crane_counterbalance', 'hyq_leg', 'rig_servo_valve', 'rig_valve', 'winch',
    'two_joint_leg', 'rig_rotary_position', 'pump_station', 'rig_hoses'])
def test_both_ends_of_every_slider_are_accepted(config):
    """As is its start, which lies between them; every fault goes on and off."""
    rig = Rig(config)
    for actuator in rig.tree['actuators']:
        for what, sliders in (('setpoint', actuator['setpoints']), ('tune', actuator['gains'])):
            assert sliders or what == 'tune'
            for own in sliders:
                assert own['low'] <= own['value'] <= own['high'] and own['low'] < own['high']
                for value in (own['low'], own['high'], own['value']):
                    rig.order(what, actuator['name'], own['name'], value * own['scale'])
    for target in (*rig.tree['actuators'], *rig.tree['supplies']):
        for fault in target['faults']:
            for is_on in (True, False):
                rig.order('fault', target['name'], fault['name'], is_on)
            assert fault['meaning']
    state = rig.controls.state()
    assert (state['faults'], state['is_stopped']) == ([], False)


def test_sliders_have_the_units_and_the_range_of_their_actuator():
    own = Rig('rig_linear').sliders()
    position = own['position']
    assert (position['unit'], position['scale'], position['low'], position['value'],
            position['high']) == ('mm', 1e-3, 0.0, 50.0, 100.0)
    assert (own['effort']['low'], own['effort']['value'], own['effort']['high']) == (
        -5174.0, 0.0, 7500.0)
    stiffness = own['stiffness']
    assert (stiffness['value'], stiffness['high'], stiffness['unit']) == (1e5, 4e5, 'N/m')
    limit = own['reu.position.force_out']
    assert limit['low'] == pytest.approx(30.0) and limit['high'] == 30000.0
    kr = own['reu.force.kr']
    assert kr['value'] == 0.0 and kr['low'] == -kr['high'] < 0.0
    assert 'position.stiffness' not in own and 'velocity' not in own


@pytest.mark.parametrize('config, mode, name, unit, high', [
    ('rig_servo_valve', 'spool', 'spool', 'mm', 0.5),
    ('rig_leakage', 'current', 'current', 'mA', 10.0),
    ('rig_rotary_position', 'position', 'position', 'deg', 99.98)])
def test_a_mode_has_its_own_setpoint(config, mode, name, unit, high):
    actuator = Rig(config).tree['actuators'][0]
    assert actuator['mode'] == mode
    own, = actuator['setpoints']
    assert (own['name'], own['unit']) == (name, unit)
    assert own['high'] == pytest.approx(high, rel=1e-4)


def test_a_motor_has_a_turn_either_way():
    own = Rig('winch').sliders()['position']
    assert (own['low'], own['value'], own['high']) == pytest.approx((-270.0, 90.0, 450.0))


def test_a_force_loop_alone_takes_efforts_up_to_the_rated_force():
    rig = Rig('rig_linear', changes={'actuators.ram.mode': 'force'})
    own = rig.sliders()
    assert 'position' not in own and 'stiffness' not in own
    rig.order('setpoint', 'ram', 'effort', 321.0)
    assert rig.tick().applied.effort == 321.0


def test_a_setpoint_keeps_what_is_in_force():
    """Set before, or without that the reference at rest."""
    rig = Rig('rig_linear')
    rig.order('setpoint', 'ram', 'effort', 60.0)
    applied = rig.tick().applied
    assert (applied.effort, applied.position) == (60.0, pytest.approx(0.05, abs=1e-4))
    rig.order('setpoint', 'ram', 'position', 0.03)
    rig.order('setpoint', 'ram', 'damping', 777.0)
    applied = rig.tick().applied
    assert (applied.effort, applied.position, applied.damping) == (60.0, 0.03, 777.0)
    rig.order('setpoint', 'ram', 'position', 0.033)     # both before one tick
    rig.order('setpoint', 'ram', 'effort', 61.0)
    applied = rig.tick().applied
    assert (applied.effort, applied.position) == (61.0, 0.033)
    rig.group.start(rig.surroundings.starts())
    rig.controls.restart()
    rig.order('setpoint', 'ram', 'position', 0.04)
    assert rig.tick().applied.effort == 0.0


def test_the_force_that_was_taken_over_is_shown_and_stays():
    """
    A load of 800 N on an actuator that is enabled at rest, though no command gave it an effort.

    The load cell's converter has steps of 5 N.
    """
    rig = Rig('rig_linear', changes={'actuators.ram.load.force': -800.0})
    position, effort, stiffness, damping = (own['name'] for own in rig.tree[
        'actuators'][0]['setpoints'])
    assert (position, effort, stiffness, damping) == (
        'position', 'effort', 'stiffness', 'damping')
    ram = rig.tick()
    (place, borne, k, d), = rig.controls.state()['setpoints']
    assert abs(borne) == pytest.approx(800.0, abs=5.0)
    assert place == pytest.approx(50.0, abs=0.1) and (k, d) == (
        ram.setpoint.stiffness, ram.setpoint.damping)
    rig.order('setpoint', 'ram', 'position', 0.051)
    assert rig.controls.state()['setpoints'][0] == pytest.approx(
        [51.0, borne, k, d], rel=1e-9)     # before its tick
    applied = rig.tick().applied
    assert (applied.effort, applied.position) == (borne, 0.051)
    assert rig.sliders()['effort']['value'] == 0.0      # at the start none was taken over


def test_the_sliders_of_another_mode_show_nothing():
    rig = Rig('rig_servo_valve')
    assert rig.controls.state()['setpoints'][0] == [None]      # the effort of the start counts
    rig.order('setpoint', rig.tree['actuators'][0]['name'], 'spool', 1e-4)
    assert rig.controls.state()['setpoints'][0] == [pytest.approx(0.1, rel=1e-9)]
    rig.tick()
    assert rig.controls.state()['setpoints'][0] == [pytest.approx(0.1, rel=1e-9)]
    rig.group.actuators[0].change_mode('current')
    assert rig.controls.state()['setpoints'][0] is None


def test_a_place_that_was_taken_over_beyond_the_stroke_is_no_refusal():
    """An end stop yields: the effort can be moved all the same."""
    rig = Rig('rig_linear')
    rig.tick()
    rig.group.actuators[0].memory.reu['setpoint']['position'] = -1e-5
    rig.order('setpoint', 'ram', 'effort', 50.0)
    applied = rig.tick().applied
    assert (applied.position, applied.effort) == (0.0, 50.0)


def test_a_refused_number_is_not_kept():
    rig = Rig('rig_linear')
    with pytest.raises(isa_ros.errors.SetpointError):
        rig.order('setpoint', 'ram', 'position', 0.2)
    rig.order('setpoint', 'ram', 'effort', 60.0)
    assert rig.tick().applied.position == pytest.approx(0.05, abs=1e-4)


def test_what_is_limited_is_told():
    rig = Rig('rig_linear', changes={'actuators.ram.beyond_range': 'limit'})
    assert rig.order('setpoint', 'ram', 'position', 0.2) == (
        'ram: setpoint position = 0.2 m, limited to 0.1 m, the stroke')


def test_a_fault_that_ends_gives_back_the_one_beneath():
    """Of one parameter: one coil is broken, then the cable, then again the coil, then none."""
    rig, key = Rig('rig_rotary'), 'plant.coil.open_coils'

    def after(name, is_on):
        rig.order('fault', 'rotor', name, is_on)
        return rig.tick().parameter(key)
    assert [after('coil_open', True), after('coils_open', True), after('coils_open', False),
            after('coil_open', False)] == [1.0, 2.0, 1.0, 0.0]
    assert [after('coil_open', True), after('coils_open', True), after('coil_open', False)] == [
        1.0, 2.0, 2.0]
    assert rig.controls.state()['faults'] == [('rotor', 'coils_open')]
    assert after('coil_open', False) == 2.0     # it is off already


def test_a_fault_of_a_scenario_stays_when_the_page_switches_off_what_is_not_on():
    rig, key = Rig('rig_rotary'), 'plant.coil.open_coils'
    rig.group.actuators[0].tune({f'{OVER}{key}': 1.0})
    rig.tick()
    rig.order('fault', 'rotor', 'coil_open', False)
    assert rig.tick().parameter(key) == 1.0


def test_a_supply_has_the_faults_of_its_kind():
    constant = Rig('rig_linear')
    names = [own['name'] for own in constant.tree['supplies'][0]['faults']]
    assert names == ['supply_low', 'return_blocked']
    constant.order('fault', 'supply', 'supply_low', True)
    ports = np.zeros(1, LOAD_PORT)
    constant.surroundings.ports(ports)
    assert ports['supply_pressure'][0] == 10e6
    with pytest.raises(ConfigError, match="'pump_trip' is unknown"):
        constant.order('fault', 'supply', 'pump_trip', True)


def test_a_part_of_a_circuit_has_its_own_faults():
    """Each by its name; its values are those of the part."""
    rig = Rig('pump_station')
    faults = {own['name']: own['meaning'] for own in rig.tree['supplies'][0]['faults']}
    supply = rig.tree['supplies'][0]['name']
    assert {'buffer: accumulator_empty', 'press_hose: supply_hose_burst'} <= set(faults)
    rig.order('fault', supply, 'buffer: accumulator_empty', True)
    assert rig.controls.state()['faults'] == [(supply, 'buffer: accumulator_empty')]
    rig.tick()
    changed = rig.surroundings.tuned
    assert [key for key in changed if 'parts.buffer.' in key]
    assert not [key for key in changed if 'parts.tool_buffer.' in key]


def test_an_actuator_has_the_faults_of_the_parts_that_it_has():
    for config, is_there in (('rig_hoses', True), ('rig_linear', False)):
        names = {own['name'] for own in Rig(config).tree['actuators'][0]['faults']}
        assert ('hose_a_burst' in names) is is_there and 'cushion_a_blocked' not in names
