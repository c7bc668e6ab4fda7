"""An emergency stop: one trips or somebody asks, all of its group stop, and what leads back."""

from dataclasses import replace
import math
from pathlib import Path
import re

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.conditions import BITS
from isa_ros.core.device import DISABLED, ENABLED, FAULT, QUICK_STOP
from isa_ros.core.signals import COMMAND, HAS_ENABLE
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import recorded_inputs
from isa_ros.scenario.scenario import scenario_of
from isa_ros.scripting.run import Run
from isa_ros.simulation import Simulation
from isa_ros.tick.emergency_stop import LONGEST_STOP
import numpy as np
import pytest
from tests.replay.test_replay_faults import content, replayed

SHIFTED = {'plant.spool.null_bias.current_ma': 2.0}
SUPPLY = {
    'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0, 'gas_volume_l': 0.32,
    'precharge_mpa': 12.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.5,
    'bulk_modulus': 1e9, 'pump_flow_lpm': 12.0, 'pump_lag_s': 0.03, 'pump_band_mpa': 0.5,
    'relief_mpa': 22.5, 'relief_lpm_per_mpa': 10.0, 'dump': {'kind': 'valve'}}
LINKED = {'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 1.0, 'jitter_us': 0.0,
          'loss': 0.0, 'watchdog_ms': 8.0}
ENDED_MS = 300  # ramp, 200 ms at rest, and closing poppets


def tree(group: Tree | None = None, **more: object) -> Tree:
    """Return a run file of three actuators with block valves; ``left`` and ``right`` stop both."""
    protection = {'spool_deviation': {'delay_ms': 10.0, 'reaction': 'block'}}
    actuator: Tree = {
        'model': 'isa_v5', 'load': {'kind': 'mass'}, 'initial_position_mm': 50.0,
        'parameters': {'plant': {'block_valve': {'kind': 'poppet'}},
                       'reu': {'protection': protection}}}
    return {
        'name': 'three', 'supply': SUPPLY,
        'actuators': {name: actuator for name in ('left', 'right', 'other')},
        'emergency_stops': {'pair': {'actuators': ['left', 'right']} | (group or {})}} | more


def run(group: Tree | None = None, **more: object) -> Run:
    return isa_ros.load(tree(group, **more))


def advance(simulation: Simulation, n_ticks: int) -> None:
    for _ in range(n_ticks):
        simulation.step()


def states(simulation: Simulation) -> list[int]:
    return [int(simulation.samples[name].device_state) for name in simulation.names]


def lifts(simulation: Simulation) -> list[float]:
    return [float(own._body.plant.block.lift) for own in simulation.group.actuators]


def dumped(simulation: Simulation) -> float:
    return float(simulation.supply_samples['supply'].dump_opening)


def moving(group: Tree | None = None, **more: object) -> Simulation:
    """Return a run in which all three move."""
    simulation = run(group, **more).simulation()
    for name in simulation.names:
        simulation.command(name, position=0.07)
    advance(simulation, 40)
    return simulation


def test_one_trips_and_its_group_stops_by_category_blocks_and_is_dumped():
    """The other actuator of the same supply is not in the group: it misses the pressure."""
    simulation = moving()
    simulation.tune('left', SHIFTED)
    advance(simulation, 13)
    assert states(simulation) == [FAULT, QUICK_STOP, ENABLED]
    advance(simulation, 100)
    assert lifts(simulation) == [0.0, 1.0, 1.0] and dumped(simulation) == 0.0
    advance(simulation, ENDED_MS)
    assert states(simulation) == [FAULT, DISABLED, FAULT]
    assert [isa_ros.conditions(simulation.samples[name].trips) for name in simulation.names] == [
        ['spool_deviation'], [], ['supply_low']]
    assert lifts(simulation) == [0.0] * 3 and dumped(simulation) > 0.9
    assert simulation.supply_samples['supply'].pressure < 1e6
    at = [float(simulation.samples[name].position) for name in ('left', 'right')]
    advance(simulation, 100)
    for name, before in zip(('left', 'right'), at):     # neither drives on, nor sinks
        assert abs(float(simulation.samples[name].position) - before) < 1e-4


@pytest.mark.parametrize(('dumps', 'after', 'later'), [
    ('at_once', True, True), ('at_rest', False, True), ('never', False, False)])
def test_the_dump_waits_for_the_end_of_the_movements_if_it_is_to(dumps, after, later):
    simulation = moving({'dumps': dumps})
    simulation.emergency_stop()
    advance(simulation, 60)
    assert (dumped(simulation) > 0.5) == after
    advance(simulation, ENDED_MS)
    assert (dumped(simulation) > 0.5) == later


def test_only_trips_with_the_chosen_reactions_stop_the_group():
    simulation = moving({'reactions': ['quick_stop']})
    simulation.tune('left', SHIFTED)
    advance(simulation, 50)
    assert states(simulation) == [FAULT, ENABLED, ENABLED]
    simulation = moving({'reactions': ['quick_stop', 'block']})
    simulation.tune('right', SHIFTED)
    advance(simulation, 50)
    assert states(simulation) == [QUICK_STOP, FAULT, ENABLED]


def test_the_way_back_is_clear_release_enable_in_this_order():
    """What its own stop took does not count as a low supply, else there were no way back."""
    simulation = moving({'actuators': ['left', 'right', 'other']})
    simulation.tune('left', SHIFTED)
    advance(simulation, ENDED_MS + 60)
    simulation.command('right', is_enabled=True)    # refused while the line is open
    advance(simulation, 5)
    assert states(simulation) == [FAULT, DISABLED, DISABLED]
    with pytest.raises(ConfigError, match='emergency_stop.pair.opened stays open: left '
                                          'spool_deviation; clear the fault first'):
        simulation.emergency_stop(False)
    simulation.tune('left', {'plant.spool.null_bias.current_ma': 0.0})
    advance(simulation, 5)
    simulation.command('left', clear_fault=True)
    advance(simulation, 2)
    assert states(simulation) == [DISABLED] * 3 and dumped(simulation) > 0.9
    simulation.emergency_stop(False, 'pair')
    advance(simulation, 400)
    assert states(simulation) == [DISABLED] * 3     # nothing starts by itself
    assert dumped(simulation) < 1e-6
    assert simulation.supply_samples['supply'].pressure > 15e6
    for name in simulation.names:
        simulation.command(name, is_enabled=True)
    advance(simulation, 60)
    assert states(simulation) == [ENABLED] * 3 and lifts(simulation) == [1.0] * 3
    simulation.command('right', position=0.055)
    advance(simulation, 200)
    assert abs(float(simulation.samples['right'].position) - 0.055) < 2e-3
    simulation.tune('right', SHIFTED)       # and it stops a second time
    advance(simulation, 13)
    assert states(simulation)[:2] == [QUICK_STOP, FAULT]


@pytest.mark.parametrize('block_valve', [
    {'kind': 'none'}, {'kind': 'poppet', 'leakage_lpm': 1.0}], ids=['none', 'leaky'])
def test_chambers_that_a_dump_has_emptied_are_no_broken_sensors_when_the_pressure_is_back(
        block_valve: Tree):
    """At once, with lines that are shut, or opened to chambers that have to be filled first."""
    supply = {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0,
              'dump': {'kind': 'lag', 'time_constant_ms': 1.0}}
    actuator = tree()['actuators']['left'] | {  # type: ignore[index]
        'parameters': {'plant': {'block_valve': block_valve}}}
    simulation = isa_ros.load(tree({'actuators': ['left']}, supply=supply, actuators={
        'left': actuator})).simulation()
    simulation.command('left', position=0.07)
    advance(simulation, 40)
    simulation.emergency_stop()
    advance(simulation, 700)
    sample = simulation.samples['left']
    assert max(sample.pressure_a, sample.pressure_b) < 1e5
    simulation.emergency_stop(False)
    advance(simulation, 150)
    simulation.command('left', is_enabled=True)
    advance(simulation, 200)
    sample = simulation.samples['left']
    assert isa_ros.conditions(sample.trips) == [] and sample.device_state == ENABLED
    assert min(sample.pressure_a, sample.pressure_b) > 1e6


def test_without_the_key_all_stop_by_request_and_no_trip_does_it():
    everything = tree()
    del everything['emergency_stops']
    simulation = isa_ros.load(everything).simulation()
    simulation.tune('left', SHIFTED)
    advance(simulation, 60)
    assert states(simulation) == [FAULT, ENABLED, ENABLED]
    simulation.emergency_stop()
    advance(simulation, 60)
    assert states(simulation) == [FAULT, QUICK_STOP, QUICK_STOP]
    simulation.emergency_stop(False)    # a trip that does not stop the group does not hold it
    advance(simulation, ENDED_MS)
    assert states(simulation) == [FAULT, DISABLED, DISABLED]


def test_an_actuator_in_two_groups_is_released_when_both_are():
    both = tree(emergency_stops={
        'pair': {'actuators': ['left', 'right'], 'dumps': 'never'}, 'cell': {'dumps': 'never'}})
    simulation = isa_ros.load(both).simulation()
    simulation.emergency_stop(group='pair')
    advance(simulation, 1)
    simulation.emergency_stop(group='cell')
    advance(simulation, ENDED_MS)
    assert states(simulation) == [DISABLED] * 3
    simulation.emergency_stop(False, 'pair')
    advance(simulation, 1)
    for name in simulation.names:
        simulation.command(name, is_enabled=True)
    advance(simulation, 60)
    assert states(simulation) == [DISABLED] * 3
    simulation.emergency_stop(False, 'cell')
    advance(simulation, 1)
    for name in simulation.names:
        simulation.command(name, is_enabled=True)
    advance(simulation, 60)
    assert states(simulation) == [ENABLED] * 3


def test_it_reaches_an_actuator_whose_link_is_lost():
    """The line is a wire of its own: the frames of the bus do not carry it."""
    simulation = moving(link=LINKED)
    simulation.tune('right', {'link.loss': 1.0})
    advance(simulation, 30)
    simulation.emergency_stop()
    advance(simulation, ENDED_MS + 60)
    exact = [int(own.sample.device_state) for own in simulation.group.actuators]
    assert exact[:2] == [DISABLED, DISABLED] and lifts(simulation)[:2] == [0.0, 0.0]
    assert dumped(simulation) == 0.0    # nobody knows that it is at rest
    while simulation.t < 0.25 + LONGEST_STOP:
        simulation.step()
    assert dumped(simulation) > 0.9     # no stop lasts longer


def test_a_run_that_is_saved_while_a_dump_waits_goes_on_byte_for_byte():
    """What it has waited is part of the state: the dump opens 2 s after the stop all the same."""
    simulation, restored = moving(link=LINKED), run(link=LINKED).simulation()
    simulation.tune('right', {'link.loss': 1.0})
    advance(simulation, 30)
    simulation.emergency_stop()
    advance(simulation, 1200)
    restored.restore(simulation.snapshot())
    for own in (simulation, restored):
        advance(own, round((LONGEST_STOP - 1.2) / 1e-3) - 2)
        assert dumped(own) == 0.0
        advance(own, 20)
        assert dumped(own) > 0.0
    assert restored.snapshot() == simulation.snapshot()


@pytest.mark.parametrize(('lasted', 'words'), [
    (b'', 'emergency stops has 0 bytes, must have 8'), (bytes(16), 'has 16 bytes, must have 8'),
    ((-1).to_bytes(8, 'little', signed=True), 'pair.opened: saved state has it open for -1 ticks'),
    ((4).to_bytes(8, 'little'), 'open for 4 ticks, must be >= 0 and <= 3')])
def test_a_saved_state_whose_line_has_been_open_for_other_ticks_is_refused(lasted, words):
    simulation = run().simulation()
    advance(simulation, 3)
    state = simulation.loop.save()
    with pytest.raises(ConfigError, match=words):
        simulation.loop.restore(replace(state, stops=lasted))
    assert simulation.loop.save() == state


def test_a_dump_waits_for_one_that_brakes_behind_a_lost_link():
    """The other is off at once: silence alone is no rest."""
    simulation = moving(link=LINKED)
    simulation.tune('right', {'link.loss': 1.0})
    simulation.step()
    simulation.emergency_stop()
    right = simulation.group.actuators[1]
    while int(right.sample.device_state) != DISABLED:
        simulation.step()
        assert dumped(simulation) == 0.0
    assert simulation.t > 0.1


def test_reactions_in_force_open_the_line():
    """One that has become weaker does not, one that has become stronger does, at that tick."""
    simulation = run({'reactions': ['disable']}).simulation()
    reaction = 'reu.protection.load_cell_implausible.reaction'
    advance(simulation, 30)
    simulation.tune('left', {reaction: 'warn'})
    simulation.tune('right', {reaction: 'warn'})
    simulation.tune('left', {'plant.sensors.force.bias': 2000.0})
    advance(simulation, 100)
    assert isa_ros.conditions(simulation.samples['left'].trips) == ['load_cell_implausible']
    assert states(simulation) == [ENABLED] * 3
    simulation.tune('right', {reaction: 'disable'})     # of the one that is sound
    advance(simulation, 10)
    assert states(simulation) == [ENABLED] * 3
    simulation.tune('left', {reaction: 'disable'})
    advance(simulation, 400)
    assert states(simulation)[:2] == [FAULT, DISABLED]


def test_a_fault_whose_reaction_has_become_weaker_is_gone_once_it_is_cleared():
    """Also while its cause lasts: then the line can be released."""
    simulation = run({'reactions': ['disable']}).simulation()
    reaction = 'reu.protection.load_cell_implausible.reaction'
    advance(simulation, 30)
    simulation.tune('left', {'plant.sensors.force.bias': 2000.0})
    advance(simulation, 400)
    assert states(simulation)[:2] == [FAULT, DISABLED]
    simulation.tune('left', {reaction: 'warn'})
    advance(simulation, 2)
    simulation.command('left', clear_fault=True)
    advance(simulation, 2)
    assert states(simulation)[0] == DISABLED
    assert isa_ros.conditions(simulation.samples['left'].trips) == ['load_cell_implausible']
    simulation.tune('left', {'plant.sensors.force.bias': 0.0})
    advance(simulation, 100)
    assert isa_ros.conditions(simulation.samples['left'].trips) == []
    simulation.emergency_stop(False)
    advance(simulation, 2)
    assert simulation.surroundings.tuned_value('emergency_stop.pair.opened') == 0.0


def test_events_of_a_run_name_its_emergency_stop():
    result = isa_ros.load(tree(), SCENARIO).simulate(0.1)
    assert (0.04, 'emergency_stop', 'pair.opened = 1') in [
        (event.t_s, event.source, event.what) for event in result.events]


def test_a_frozen_program_is_blocked_too():
    simulation = moving()
    simulation.tune('right', {'reu.frozen': 1.0})
    simulation.emergency_stop()
    advance(simulation, 60)
    assert lifts(simulation)[1] == 0.0


SCENARIO: Tree = {
    'name': 'stopped', 'duration_s': 0.6,
    'tracks': {'right': [{'t_s': 0.0, 'position': 0.07},
                         {'t_s': 0.56, 'enabled': True, 'position': 'hold'}]},
    'faults': [{'t_s': 0.04, 'emergency_stop': 'pair', 'until_s': 0.45},
               {'t_s': 0.2, 'actuator': 'left', 'set': SHIFTED}]}


def test_a_scenario_stops_and_releases_and_its_bag_replays_byte_for_byte(tmp_path: Path):
    """With a trip in the middle, which keeps the line open beyond the scenario's release."""
    scenario = isa_ros.load(tree(), SCENARIO)
    result = scenario.simulate()
    assert result['right.device_state'][60] == QUICK_STOP
    assert result['right.device_state'][-1] == DISABLED     # the trip of the other one holds it
    assert result['supply.dump_opening'][-1] > 0.9
    bag = result.save(tmp_path / 'bag')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    found = recorded_inputs(Bag(bag), scenario.configuration)
    opened = {tick: values for tick, values in found.tuned_supplies.items()
              if 'emergency_stop.pair.opened' in values}
    assert opened == {40: {'emergency_stop.pair.opened': 1.0}}
    assert found.tuned['left'][40] == found.tuned['right'][40] == {
        'reu.device.emergency_stop': 1.0}
    assert 40 not in found.tuned.get('other', {})


def test_without_that_trip_the_scenario_comes_back():
    alone = SCENARIO | {'faults': SCENARIO['faults'][:1]}   # type: ignore[index]
    result = isa_ros.load(tree(), alone).simulate()
    assert result['right.device_state'][-1] == ENABLED
    assert result['supply.dump_opening'][-1] < 0.01
    text = isa_ros.load(tree(), alone).scenario.to_yaml()
    assert 'emergency_stop: pair' in text
    own = isa_ros.load(tree(), alone).scenario
    assert scenario_of(text, own.run).faults == own.faults


@pytest.mark.parametrize('at', [20, 200, 380])
def test_a_run_that_is_saved_and_restored_goes_on_byte_for_byte(at: int):
    """While they brake, while all is off, and while the line waits for its release."""
    simulation, twin = moving(), moving()
    for own in (simulation, twin):
        own.tune('left', SHIFTED)
        advance(own, at)
    restored = run().simulation()
    restored.restore(simulation.snapshot())
    for own in (restored, twin):
        own.tune('left', {'plant.spool.null_bias.current_ma': 0.0})
        advance(own, 2)
        own.command('left', clear_fault=True)
        advance(own, 2)
        own.emergency_stop(False)
        advance(own, 2)
        own.command('right', is_enabled=True)
        advance(own, 60)
    assert restored.snapshot() == twin.snapshot()
    assert states(twin)[0] == DISABLED


def test_a_released_line_is_told_before_the_first_tick_of_a_restored_run():
    simulation = moving()
    simulation.emergency_stop()
    advance(simulation, ENDED_MS)
    restored = run().simulation()
    restored.restore(simulation.snapshot())
    restored.emergency_stop(False)
    advance(restored, 200)
    restored.command('right', is_enabled=True)
    advance(restored, 60)
    assert states(restored)[1] == ENABLED and dumped(restored) < 1e-3


def test_what_is_enabled_before_the_pressure_is_back_is_refused_with_the_reason():
    """It tripped by supply_low, which opened the line of the whole group again."""
    simulation = moving()
    simulation.emergency_stop()
    advance(simulation, ENDED_MS + 50)
    simulation.emergency_stop(False)
    advance(simulation, 2)
    right = simulation.group.actuators[1]
    row = np.zeros(1, COMMAND)[0]
    row['kinds'], row['is_enabled'] = HAS_ENABLE, 1
    is_taken, answer = right.request(row, 'enable')
    assert not is_taken
    assert re.search(r'the supply pressure is \d\.\d\d MPa: what the emergency stop took is not '
                     'back$', answer)
    simulation.command('right', is_enabled=True)
    advance(simulation, 5)
    sample = simulation.samples['right']
    assert (sample.device_state, sample.trips, sample.refused_requests) == (DISABLED, 0.0, 1.0)
    assert isa_ros.conditions(sample.warnings) == ['supply_low']
    advance(simulation, 400)
    simulation.command('right', is_enabled=True)
    advance(simulation, 60)
    assert states(simulation)[1] == ENABLED
    assert isa_ros.conditions(simulation.samples['right'].warnings) == []


@pytest.mark.parametrize('dump', [
    SUPPLY, {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0,
             'dump': {'kind': 'lag', 'time_constant_ms': 100.0}}], ids=['valve', 'lag'])
def test_a_release_while_the_pressure_still_falls_ends_with_the_pressure_back(dump: Tree):
    """Supply_low tripped 10 ms after it fell below 4.4 MPa, and the line was open again."""
    simulation = moving({'dumps': 'at_once', 'actuators': ['left', 'right', 'other']},
                        supply=dump)
    for name in simulation.names:   # off before the pressure falls: nothing of them trips
        simulation.command(name, is_enabled=False)
    advance(simulation, 1)
    simulation.emergency_stop()
    supply = simulation.supply_samples['supply']
    while supply.pressure > 14e6:
        simulation.step()
    simulation.emergency_stop(False)
    lowest = float(supply.pressure)
    for _ in range(500):
        simulation.step()
        lowest = min(lowest, float(supply.pressure))
        assert simulation.surroundings.tuned_value('emergency_stop.pair.opened') == 0.0
    assert supply.pressure > 15e6
    assert states(simulation) == [DISABLED] * 3
    if dump is SUPPLY:
        assert lowest < 4.4e6
    for name in simulation.names:
        simulation.command(name, is_enabled=True)
    advance(simulation, 60)
    assert states(simulation) == [ENABLED] * 3
    simulation.tune('supply', {'pressure_mpa': 2.0} if dump is not SUPPLY else {
        'dump.opened': 1.0})    # and a supply that is lost later trips
    advance(simulation, 400)
    assert isa_ros.conditions(simulation.samples['left'].trips)[0] == 'supply_low'


@pytest.mark.parametrize('value', [0.5, 2, math.nan, 'on', None])
def test_what_is_neither_open_nor_released_is_refused(value):
    simulation = run().simulation()
    with pytest.raises(ConfigError, match=rf'emergency_stop = {value!r}, must be True \(open\) '
                                          r'or False \(released\)$'):
        simulation.emergency_stop(value)


@pytest.mark.parametrize(('value', 'words'), [
    (0.5, '= 0.5, must be a whole number'), (2.0, '= 2, must be <= 1'),
    (math.nan, '= nan, must be finite'), (True, '= True, must be a number')])
def test_a_line_that_is_set_as_a_parameter_is_open_or_not(value, words):
    simulation = run().simulation()
    with pytest.raises(ConfigError, match=f'emergency_stop.pair.opened {words}'):
        simulation.surroundings.tune({'emergency_stop.pair.opened': value})
    assert simulation.surroundings.tuned_value('emergency_stop.pair.opened') == 0.0


@pytest.mark.parametrize('link', [None, {
    'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 1.0, 'jitter_us': 0.0, 'loss': 0.0,
    'watchdog_ms': 8.0}], ids=['direct', 'link'])
def test_a_restored_run_has_the_reactions_in_force(link: Tree | None):
    """It had those of the sheets until a reaction changed again."""
    more = {} if link is None else {'link': link}
    reaction = 'reu.protection.load_cell_implausible.reaction'
    saved = run({'reactions': ['disable']}, **more).simulation()
    saved.tune('left', {reaction: 'warn'})
    saved.tune('right', {'reu.protection.spool_deviation.reaction': 'disable'})
    advance(saved, 30)
    for actuator, fault, states_then in (
            ('left', {'plant.sensors.force.bias': 2000.0}, [ENABLED] * 3),
            ('right', SHIFTED, [QUICK_STOP, FAULT, ENABLED])):
        restored = run({'reactions': ['disable']}, **more).simulation()
        restored.restore(saved.snapshot())
        restored.tune(actuator, fault)
        advance(restored, 100)
        assert restored.samples[actuator].trips
        assert states(restored) == states_then


def test_a_reset_forgets_the_reactions_of_a_fault_that_is_taken_off():
    weak = {'t_s': 0.0, 'actuator': 'left', 'until_s': 0.5,
            'set': {'reu.protection.spool_deviation.reaction': 'warn'}}
    simulation = isa_ros.load(tree(), {
        'name': 'weak', 'duration_s': 1.0, 'faults': [weak]}).simulation()
    advance(simulation, 20)
    assert simulation.loop.stops is not None
    simulation.loop.stops.restart()
    sample = simulation.group.samples.copy()
    sample['trips'][0] = 1 << BITS['spool_deviation']
    simulation.loop.stops.act(sample, {})
    assert simulation.surroundings.tuned_value('emergency_stop.pair.opened') == 1.0


def test_a_reset_keeps_the_line_as_it_keeps_all_tuned_values():
    simulation = moving()
    simulation.emergency_stop()
    advance(simulation, 10)
    simulation.reset()
    advance(simulation, 5)
    assert states(simulation) == [DISABLED, DISABLED, ENABLED]
    simulation.emergency_stop(False)
    simulation.reset()
    advance(simulation, 5)
    assert states(simulation) == [ENABLED] * 3


def test_the_configuration_comes_back_from_its_text():
    own = run().configuration
    assert run_of_text(own.to_yaml()) == own
    plain = replace(own, emergency_stops=())
    assert 'emergency_stops' not in plain.to_yaml()
    assert [group.actuators for group in plain.stop_groups] == [('left', 'right', 'other')]


@pytest.mark.parametrize(('group', 'words'), [
    ({'actuators': []}, 'emergency_stops.pair.actuators is empty'),
    ({'actuators': ['left', 'rigth']}, "'rigth' is not an actuator; did you mean right"),
    ({'reactions': ['hold']}, "reactions: 'hold', must be of quick_stop, disable, block"),
    ({'dumps': 'later'}, 'must be one of at_rest, at_once, never')])
def test_a_group_that_cannot_be_is_refused(group, words):
    with pytest.raises(ConfigError, match=words):
        run(group)


def test_a_group_that_dumps_at_once_has_a_dump_valve():
    ideal = {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0}
    with pytest.raises(ConfigError, match=(
            'emergency_stops.pair.dumps = at_once is not used: no dump valve is in supply')):
        isa_ros.load({**tree({'dumps': 'at_once'}), 'supply': ideal})
    isa_ros.load({**tree({'dumps': 'at_rest'}), 'supply': ideal})
    isa_ros.load({**tree({'dumps': 'at_once'}), 'supply': {**ideal, 'dump': {
        'kind': 'lag', 'time_constant_ms': 1.0}}})


@pytest.mark.parametrize(('fault', 'words'), [
    ({'emergency_stop': 'par'}, "'par' is not a group; did you mean pair"),
    ({'emergency_stop': 'pair', 'set': {'opened': 1}}, 'set is not used'),
    ({'emergency_stop': 'pair', 'supply': 'supply'}, 'must have one of')])
def test_a_row_of_a_scenario_that_stops_no_group_is_refused(fault, words):
    with pytest.raises(ConfigError, match=words):
        isa_ros.load(tree(), {'name': 'bad', 'duration_s': 0.1, 'faults': [{'t_s': 0.0} | fault]})


def test_a_request_for_a_group_that_is_not_there_is_refused():
    with pytest.raises(ConfigError, match="'legs' is not a group; valid: pair"):
        run().simulation().emergency_stop(group='legs')


def test_no_supply_has_the_name_of_the_lines():
    named = tree()
    named['supplies'] = {'emergency_stop': named.pop('supply') | {  # type: ignore[operator]
        'feeds': ['left', 'right', 'other']}}
    with pytest.raises(ConfigError, match='the name is taken by the lines of emergency stops'):
        isa_ros.load(named)


def test_each_stop_waits_anew_for_what_is_silent():
    """Two stops of 1.2 s behind a lost link are no stop of 2.4 s."""
    simulation = run().simulation()
    stops, samples = simulation.loop.stops, simulation.group.samples.copy()
    assert stops is not None
    samples['is_stale'] = 1.0

    def opened() -> bool:
        return simulation.surroundings.tuned_value('supply.dump.opened') == 1.0

    n = round(0.6 * LONGEST_STOP / 1e-3)
    for _ in range(2):
        stops.request(True, samples)
        for _ in range(n):
            stops.act(samples, {})
        assert not opened()
        stops.request(False, samples)
        stops.act(samples, {})
    stops.request(True, samples)
    for _ in range(round(LONGEST_STOP / 1e-3)):
        stops.act(samples, {})
    assert opened()


def test_the_supply_of_others_is_not_dumped():
    plain = tree()
    supplies = {name: plain['supply'] | {'feeds': feeds} for name, feeds in (  # type: ignore
        ('own', ['left', 'right']), ('theirs', ['other']))}
    del plain['supply']
    simulation = isa_ros.load(plain | {'supplies': supplies}).simulation()
    advance(simulation, 20)
    simulation.emergency_stop(group='pair')
    advance(simulation, ENDED_MS + 50)
    opening = {name: float(own.dump_opening)
               for name, own in simulation.supply_samples.items()}
    assert opening['own'] > 0.5 and opening['theirs'] == 0.0
    assert states(simulation) == [DISABLED, DISABLED, ENABLED]


def test_a_supply_that_was_not_dumped_is_watched_from_the_next_enable_on():
    """And before it: nothing has taken the pressure of a group without a dump."""
    simulation = moving({'dumps': 'never'})
    simulation.emergency_stop()
    advance(simulation, ENDED_MS)
    simulation.emergency_stop(False)
    advance(simulation, 2)
    simulation.command('left', is_enabled=True)
    advance(simulation, 60)
    simulation.tune('supply', {'dump.opened': 1.0})
    advance(simulation, 100)
    tripped = [isa_ros.conditions(simulation.samples[name].trips) for name in simulation.names]
    assert tripped[0][0] == 'supply_low'
    # the line is open again, and takes the pressure of the others
    assert simulation.surroundings.tuned_value('emergency_stop.pair.opened') == 1.0
