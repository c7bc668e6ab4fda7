"""An emergency stop in a run that is saved, restored, reset or replayed."""

from dataclasses import replace
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.conditions import BITS
from isa_ros.core.device import DISABLED, ENABLED, FAULT, QUICK_STOP
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import recorded_inputs
from isa_ros.scenario.scenario import scenario_of
from isa_ros.tick.emergency_stop import LONGEST_STOP
import pytest
from tests.replay.replayed import content, replayed
from tests.tick.stopped_group import (
    advance, dumped, ENDED_MS, LINKED, moving, run, SCENARIO, SHIFTED, states, tree)


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
