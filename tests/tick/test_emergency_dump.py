"""The dump of a group's supply: when it opens, what it takes, and how the pressure comes back."""

import re

import isa_ros
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.device import DISABLED, ENABLED
from isa_ros.core.signals import COMMAND, HAS_ENABLE
from isa_ros.tick.emergency_stop import LONGEST_STOP
import numpy as np
import pytest
from tests.tick.stopped_group import (
    advance, dumped, ENDED_MS, LINKED, moving, run, states, SUPPLY, tree)


@pytest.mark.parametrize(('dumps', 'after', 'later'), [
    ('at_once', True, True), ('at_rest', False, True), ('never', False, False)])
def test_the_dump_waits_for_the_end_of_the_movements_if_it_is_to(dumps, after, later):
    simulation = moving({'dumps': dumps})
    simulation.emergency_stop()
    advance(simulation, 60)
    assert (dumped(simulation) > 0.5) == after
    advance(simulation, ENDED_MS)
    assert (dumped(simulation) > 0.5) == later


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
