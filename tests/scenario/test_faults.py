"""Faults of a scenario: when values change and come back, and what is refused in one line."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import isa_ros
from isa_ros.config.models.fault_catalogue import (
    ACTUATOR, common_faults, fault_catalogue, SUPPLY)
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.config.text.sections import Place
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.fault_reading import read_faults
from isa_ros.scenario.faults import Fault, timetable
from isa_ros.scenario.scenario import idle, scenario_of
from isa_ros.simulation import Simulation
import pytest
from tests.runs import ACCUMULATOR, BUS, hip_and_knee

ALONE = load_run(find('rig_linear', CONFIG))
RUN = hip_and_knee([SupplyConfig('pump', ACCUMULATOR, ('hip', 'knee'))], BUS)
STUCK, LEAK = 'plant.spool.stuck', 'plant.oil.cross_port_leakage'


def faults(*trees: Any, run: RunConfig = RUN) -> tuple[Fault, ...]:
    """Return the faults of a run of 1 s."""
    return read_faults(list(trees), Place('s.yaml', 'faults'), run, 1000)


def knee(*trees: Mapping[str, Any]) -> dict[int, dict[str, float]]:
    """Return what changes of the knee by tick."""
    found = timetable(faults(*({'actuator': 'knee'} | dict(tree) for tree in trees)), RUN)
    return {tick: dict(own.actuators[1]) for tick, own in found.items() if 1 in own.actuators}


def test_a_fault_begins_at_its_tick_and_ends_at_its_tick():
    """It lies over the value, and is taken off."""
    assert knee({'t_s': 0.5, 'set': {STUCK: 1}, 'until_s': 0.8}) == {
        500: {f'+{STUCK}': 1.0}, 800: {f'-{STUCK}': 0.0}}


def test_a_fault_from_the_beginning_and_without_end_is_there_at_tick_0():
    assert knee({'t_s': 0.0, 'set': {STUCK: 1}}) == {0: {f'+{STUCK}': 1.0}}


def test_of_two_faults_of_one_parameter_the_later_counts_and_then_the_earlier_again():
    leaks = ({'t_s': 0.1, 'set': {LEAK: 1e-12}, 'until_s': 0.6},
             {'t_s': 0.3, 'set': {LEAK: 2e-12}, 'until_s': 0.4})
    over = f'+{LEAK}'
    expected = {100: {over: 1e-12}, 300: {over: 2e-12}, 400: {over: 1e-12},
                600: {f'-{LEAK}': 0.0}}
    assert knee(*leaks) == knee(*reversed(leaks)) == expected


def test_a_fault_that_ends_while_a_later_one_lasts_changes_nothing():
    assert knee({'t_s': 0.1, 'set': {LEAK: 1e-12}, 'until_s': 0.4},
                {'t_s': 0.3, 'set': {LEAK: 2e-12}}) == {
        100: {f'+{LEAK}': 1e-12}, 300: {f'+{LEAK}': 2e-12}}


@pytest.mark.parametrize('name', common_faults())
def test_every_common_fault_of_the_catalogue_fits_and_changes_something(name):
    own = fault_catalogue()[name]
    target = 'knee' if own.of == ACTUATOR else 'pump'
    one, = faults({'t_s': 0.5, own.of: target, 'fault': name})
    assert dict(one.values) == dict(own.values) and own.meaning
    changes = timetable([one], RUN)[500]
    assert changes.supplies if own.of == SUPPLY else changes.actuators[1]


def test_a_named_fault_takes_another_size_and_more_keys():
    one, = faults({'t_s': 0.5, 'actuator': 'knee', 'fault': 'internal_leak',
                   'set': {LEAK: 5e-12, STUCK: 1}})
    assert one.values == {LEAK: 5e-12, STUCK: 1.0}


def test_keys_in_sections_are_those_with_dots():
    one, = faults({'t_s': 0.5, 'actuator': 'knee', 'set': {
        'plant': {'spool': {'stuck': 1}, 'oil': {'cross_port_leakage': 5e-12}}}})
    assert one.values == {STUCK: 1.0, LEAK: 5e-12}


def test_a_gain_is_given_in_si_by_its_name_or_in_the_unit_of_its_key():
    one, two = faults({'t_s': 0.5, 'actuator': 'knee', 'set': {'force.kp': 1e-7}},
                      {'t_s': 0.5, 'actuator': 'knee', 'set': {'reu.force.kp': 1e-7}})
    assert one.values == two.values == {'force.kp': 1e-7}


def test_a_scenario_is_written_as_it_was_read():
    text = ('name: broken\nduration_s: 1.0\nfaults:\n'
            '- {t_s: 0.5, actuator: knee, fault: valve_stuck, until_s: 0.8}\n'
            '- {t_s: 0.25, supply: pump, set: {pump_flow_lpm: 0}}\n'
            '- {t_s: 0.25, bus: hip, set: {pulled: 1}, until_s: 0.5}\n')
    scenario = scenario_of(text, RUN)
    again = scenario_of(scenario.to_yaml(), RUN)
    assert again.faults == scenario.faults and len(again.faults) == 3
    assert [tick for tick in range(1000) if tick in scenario.changes] == [
        250, 500, 800]
    assert 'faults' not in idle(RUN, 1.0).to_yaml()


@pytest.mark.parametrize(('tree', 'message'), [
    ({'t_s': 0.1, 'actuator': 'knee', 'fault': 'valve_stck'},
     r"faults\[0\].fault = 'valve_stck' is unknown; did you mean valve_stuck?"),
    ({'t_s': 0.1, 'actuator': 'knee', 'fault': 'pump_trip'},
     r"faults\[0\].fault = 'pump_trip' is a fault of the supply, must be one of the actuator"),
    ({'t_s': 0.1, 'actuator': 'elbow', 'fault': 'valve_stuck'},
     r"faults\[0\].fault: rig.yaml: no actuator 'elbow'; valid: hip, knee"),
    ({'t_s': 0.1, 'supply': 'pumpe', 'fault': 'pump_trip'},
     r"faults\[0\].supply = 'pumpe' is not a supply; did you mean pump?"),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {'plant.spool.stuk': 1}},
     r'faults\[0\].set: plant.spool.stuk is unknown or does not change during a run; did you'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {'plant.drive.bore_mm': 20}},
     r'plant.drive.bore_mm is unknown or does not change during a run'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {STUCK: 0.5}},
     r'plant.spool.stuck = 0.5, must be a whole number'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {LEAK: 1.0}},
     r'cross_port_leakage = 1 m3/s/Pa, must be <= 1e-11 m3/s/Pa'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {STUCK: True}},
     r'set.plant.spool.stuck = True, must be a number'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {STUCK: float('nan')}},
     r'set.plant.spool.stuck = nan, must be finite$'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {STUCK: 1, 'plant': {'spool': {'stuck': 1}}}},
     r'set.plant.spool.stuck stands twice'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {'plant': {'spool': {}}}},
     r'set.plant.spool is empty'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {}}, r'faults\[0\].set is empty'),
    ({'t_s': 0.1, 'actuator': 'knee'}, r'faults\[0\] needs set, or fault'),
    ({'t_s': 0.1, 'fault': 'valve_stuck'}, r'faults\[0\] has no target, must have one of'),
    ({'t_s': 0.1, 'actuator': 'knee', 'supply': 'pump', 'fault': 'pump_trip'},
     r'faults\[0\] has actuator and supply, must have one of'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {STUCK: 1}, 'until_s': 0.1},
     r'faults\[0\].until_s = 0.1 s, must be > t_s = 0.1 s'),
    ({'t_s': 0.1005, 'actuator': 'knee', 'set': {STUCK: 1}},
     r'faults\[0\].t_s = 0.1005 s, must be a multiple of'),
    ({'t_s': 1.0, 'actuator': 'knee', 'set': {STUCK: 1}},
     r'faults\[0\].t_s = 1 s, must be < duration_s = 1 s'),
    ({'t_s': -1.0, 'actuator': 'knee', 'set': {STUCK: 1}}, r't_s = -1 s, must be >= 0 s'),
    ({'actuator': 'knee', 'set': {STUCK: 1}}, r'faults\[0\] lacks t_s'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {STUCK: 1}, 'till_s': 2},
     r'faults\[0\].till_s is unknown; did you mean until_s?'),
    ({'t_s': 0.1, 'link': 'knee', 'set': {'colour': 0.1}}, r'link.colour is unknown'),
    ({'t_s': 0.1, 'link': 'knee', 'fault': 'reu_frozen'},
     r"faults\[0\].fault = 'reu_frozen' is a fault of the actuator, must be one of the link"),
    ({'t_s': 0.1, 'supply': 'pump', 'set': {'gas_volume_l': 1.0}},
     r'gas_volume_l of pump, a supply of kind accumulator, is unknown or does not change'),
    ({'t_s': 0.1, 'actuator': 'knee', 'set': {'reu.protection.setpoint_timeout_ms': 0.9}},
     'setpoint_timeout_ms = 0.9 ms, must be >= step_ms = 1 ms, as setpoints come once a tick'),
    ({'t_s': 0.1, 'bus': 'knee', 'set': {'puled': 1}}, 'set: puled is unknown .*; did you'),
    ({'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 2}}, 'pulled = 2, must be <= 1'),
    ({'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 0.5}}, 'pulled = 0.5, must be a whole number'),
    ({'t_s': 0.1, 'bus': 'elbow', 'set': {'pulled': 1}}, "no actuator 'elbow'; valid: hip, knee"),
    ({'t_s': 0.1, 'bus': 'knee', 'fault': 'valve_stuck'}, 'is a fault of the actuator, must be'),
    ({'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 1}, 'until_s': 0.2,
      'sine': {'amplitude': 1, 'frequency_hz': 2}}, 'set: sine is not used with a bus'),
    ({'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 1}, 'ramp_s': 0.1},
     r'faults\[0\].set: ramp_s is not used with a bus'),
    ({'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 'on'}}, "pulled = 'on', must be a number"),
    ('valve_stuck', r"faults\[0\] = 'valve_stuck', must be a section")])
def test_a_bad_fault_is_refused_in_one_line_with_its_place(tree, message):
    with pytest.raises(ConfigError, match=message) as raised:
        faults(tree)
    assert str(raised.value).startswith('s.yaml: faults[0]') and '\n' not in str(raised.value)


def test_values_that_are_refused_together_are_refused_with_their_time():
    """An accumulator whose line alone cannot hold the pressure over a tick."""
    small = replace(ACCUMULATOR, line_volume_l=0.001)
    run = hip_and_knee([SupplyConfig('pump', small, ('hip', 'knee'))], BUS)
    with pytest.raises(ConfigError, match=r's.yaml: faults: at 0.2 s, pump: capacitance over'):
        faults({'t_s': 0.2, 'supply': 'pump', 'fault': 'accumulator_empty'}, run=run)


def test_faults_that_are_no_list_are_refused():
    with pytest.raises(ConfigError, match="faults = 'x', must be a list of faults"):
        read_faults('x', Place('s.yaml', 'faults'), RUN, None)


def test_a_fault_is_written_at_its_time():
    one, = faults({'t_s': 0.123, 'actuator': 'knee', 'set': {STUCK: 1}})
    assert one.tree(RUN.step_ns)['t_s'] == 123 * RUN.step_ns / NS_PER_SECOND


PUSH = {'t_s': 0.2, 'actuator': 'knee', 'set': {'load.force': -500.0}}
SINE = {'amplitude': 300.0, 'frequency_hz': 250.0}


def test_a_wave_is_added_to_the_value_at_each_tick_until_its_end():
    """250 Hz at ticks of 1 ms: 0, 1, 0, -1 of the amplitude; then the value of the sheet."""
    found = timetable(faults({**PUSH, 'actuator': 'ram', 'until_s': 0.205, 'sine': SINE},
                             run=ALONE), ALONE)
    values = [found[tick].actuators[0]['+load.force'] for tick in range(200, 205)]
    # sin() of a multiple of pi is not exactly 0: 1e-15 of 300 N
    assert values == pytest.approx([-500.0, -200.0, -500.0, -800.0, -500.0], abs=1e-9)
    assert found[205].actuators[0] == {'-load.force': 0.0}
    assert sorted(found) == [*range(200, 206)]


def test_changes_are_read_as_faults_are_and_written_back():
    text = ('name: pushed\nduration_s: 1.0\nchanges:\n'
            '- {t_s: 0.2, actuator: ram, set: {load.force: -500}, until_s: 0.7,\n'
            '   pulse: {amplitude: 20.0, period_s: 0.01, width_s: 0.002}}\n'
            'faults:\n- {t_s: 0.3, actuator: ram, fault: valve_stuck}\n')
    scenario = scenario_of(text, ALONE)
    assert [fault.tick for fault in scenario.faults] == [300, 200]
    assert scenario_of(scenario.to_yaml(), ALONE).faults == scenario.faults
    changed = {tick: scenario.changes[tick].actuators[0]['+load.force'] for tick in (200, 202)}
    assert changed == {200: -480.0, 202: -500.0} and 201 not in scenario.changes


@pytest.mark.parametrize(('tree', 'message'), [
    ({**PUSH, 'sine': SINE}, r'faults\[0\] has sine: needs one value in set, and until_s'),
    ({**PUSH, 'until_s': 0.5, 'sine': SINE, 'pulse': {}}, r'has sine and pulse, must have one'),
    ({**PUSH, 'until_s': 0.5, 'sine': SINE, 'set': {'load.force': 0, 'load.inertia': 20}},
     r'has sine: needs one value in set'),
    ({**PUSH, 'until_s': 0.5, 'sine': {**SINE, 'frequency_hz': 600.0}},
     r'faults\[0\].sine.frequency_hz = 600 Hz, must be <= 500 Hz'),
    ({**PUSH, 'until_s': 0.5, 'sine': {**SINE, 'moves': 'effort'}},
     r'faults\[0\].sine.moves is not used: it is added to load.force'),
    ({**PUSH, 'until_s': 0.5, 'sine': {**SINE, 'amplitude': 2e7}},
     r'at 0.2 s, load.force = -2.00005e\+07 N, must be >= -2e\+07 N '),
    ({**PUSH, 'until_s': 0.5, 'set': {'load.force': 1.9e7}, 'sine': {**SINE, 'amplitude': 2e6}},
     r'at 0.2 s, load.force = 2.1e\+07 N, must be <= 2e\+07 N '),
    ({**PUSH, 'set': {'load.inertia': 1e-6}}, r'set: load.inertia = 1e-06 kg, must be >= '),
])
def test_a_bad_push_is_refused_in_one_line(tree, message):
    with pytest.raises(ConfigError, match=message) as raised:
        faults({**tree, 'actuator': 'ram'}, run=ALONE)
    assert str(raised.value).startswith('s.yaml: faults') and '\n' not in str(raised.value)


def test_the_load_of_an_actuator_that_moves_a_body_cannot_be_changed():
    with pytest.raises(ConfigError, match=r'faults\[0\].set: load.force is not used: the actuator '
                                          'moves a body'):
        faults({**PUSH, 'actuator': 'kfe'}, run=load_run(find('leg', CONFIG)))


def test_faults_of_a_bus_are_by_name_of_the_actuator_and_0_where_they_end():
    found = timetable(faults(
        {'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 1}, 'until_s': 0.3},
        {'t_s': 0.2, 'bus': 'hip', 'set': {'powerless': 1, 'bus_off': 1}}), RUN)
    assert {tick: own.ports for tick, own in found.items()} == {
        100: {'knee': {'pulled': 1.0}}, 200: {'hip': {'powerless': 1.0, 'bus_off': 1.0}},
        300: {'knee': {'pulled': 0.0}}}
    assert not any(own.actuators or own.supplies for own in found.values())


def test_a_loose_contact_of_a_cable_comes_and_goes():
    found = timetable(faults({
        't_s': 0.1, 'bus': 'knee', 'set': {'pulled': 1}, 'until_s': 0.3,
        'intermittent': {'period_s': 0.1, 'duty': 0.5}}), RUN)
    assert {tick: own.ports['knee']['pulled'] for tick, own in found.items()} == {
        100: 1.0, 150: 0.0, 200: 1.0, 250: 0.0}


def test_without_a_bus_its_faults_are_refused():
    scenario = idle(RUN, 1.0).with_faults([{'t_s': 0.1, 'bus': 'knee', 'set': {'pulled': 1}}])
    with pytest.raises(ConfigError, match='fault of bus: knee is used under isa bus only; link:'):
        Simulation(scenario)


@pytest.mark.parametrize('change, message', [
    ({'body': 'robot', 'set': {'push_y': 10.0}},
     "changes[0].set: 'robot' is not a body that may be pushed; valid: body"),
    ({'body': 'body', 'set': {'push_q': 10.0}}, 'push_q of body is unknown or does not change'),
    ({'body': 'body', 'set': {'push_y': 2e5}}, 'push_y = 200000 N, must be <= 100000 N'),
    ({'body': 'body', 'fault': 'pump_trip'}, 'changes[0].fault')])
def test_pushes_of_a_body_are_checked_as_they_are_read(change, message):
    """With the names and bounds of what pushes a robot."""
    with pytest.raises(ConfigError) as refused:
        isa_ros.load('quadruped', {'name': 'push', 'duration_s': 0.1, 'changes': [
            {'t_s': 0.01, **change}]})
    assert message in str(refused.value)
