"""An emergency stop: one trips or somebody asks, all of its group stop, and what leads back."""

import isa_ros
from isa_ros.core.device import DISABLED, ENABLED, FAULT, QUICK_STOP
from isa_ros.errors import ConfigError
from isa_ros.tick.emergency_stop import LONGEST_STOP
import pytest
from tests.tick.stopped_group import (
    advance, dumped, ENDED_MS, lifts, LINKED, moving, run, SCENARIO, SHIFTED, states, tree)


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
