"""Ramps and intermittent faults: when values change, the same in every run, and refused ones."""

from isa_ros.scenario.fault_courses import Intermittent
from isa_ros.scenario.scenario import scenario_of
import pytest
from tests.scenario.test_faults import ConfigError, faults, knee, LEAK, RUN, STUCK

BIAS, OVER, OFF = 'plant.sensors.force.bias', f'+{LEAK}', f'-{LEAK}'


def test_a_ramp_leads_from_the_value_of_the_sheet_to_its_own_and_stays():
    """(v - v_0) k/n over v_0: a quarter a tick over 4 ticks; taken off at its end."""
    own = RUN.actuators[1].sheet.plant.friction.coulomb
    found = knee({'t_s': 0.5, 'ramp_s': 0.004, 'until_s': 0.8,
                  'set': {'plant.friction.coulomb': 3.0 * own, BIAS: 400.0}})
    assert list(found) == [500, 501, 502, 503, 504, 800]
    assert [found[tick]['+plant.friction.coulomb'] for tick in range(500, 505)] == pytest.approx(
        [own, 1.5 * own, 2.0 * own, 2.5 * own, 3.0 * own], rel=1e-12, abs=0.0)
    assert [found[tick][f'+{BIAS}'] for tick in range(500, 505)] == [0.0, 100.0, 200.0, 300.0, 400]
    assert found[800] == {'-plant.friction.coulomb': 0.0, f'-{BIAS}': 0.0}


def test_a_ramp_that_ends_early_or_never_has_no_more_ticks():
    early = knee({'t_s': 0.5, 'ramp_s': 0.004, 'until_s': 0.502, 'set': {BIAS: 400.0}})
    assert early == {500: {f'+{BIAS}': 0.0}, 501: {f'+{BIAS}': 100.0}, 502: {f'-{BIAS}': 0.0}}
    never = knee({'t_s': 0.5, 'ramp_s': 0.002, 'set': {BIAS: 400.0}})
    assert [own[f'+{BIAS}'] for own in never.values()] == [0.0, 200.0, 400.0]


def test_what_lies_beneath_a_ramp_comes_back_with_its_end():
    found = knee({'t_s': 0.1, 'set': {LEAK: 1e-12}},
                 {'t_s': 0.3, 'ramp_s': 0.002, 'until_s': 0.4, 'set': {LEAK: 4e-12}})
    assert found[302] == {OVER: 4e-12} and found[400] == {OVER: 1e-12}


def test_an_intermittent_fault_is_on_at_the_begin_of_each_period():
    """3 of 10 ticks, from its begin on; nothing of it is left after its end."""
    found = knee({'t_s': 0.5, 'until_s': 0.525, 'set': {LEAK: 1e-12},
                  'intermittent': {'period_s': 0.01, 'duty': 0.3}})
    on, off = {OVER: 1e-12}, {OFF: 0.0}
    assert found == {500: on, 503: off, 510: on, 513: off, 520: on, 523: off}
    cut = knee({'t_s': 0.5, 'until_s': 0.502, 'set': {LEAK: 1e-12},
                'intermittent': {'period_s': 0.01, 'duty': 0.3}})
    assert cut == {500: on, 502: off}


def test_between_two_times_on_there_is_what_lies_beneath():
    found = knee({'t_s': 0.4, 'set': {LEAK: 5e-13}},
                 {'t_s': 0.5, 'until_s': 0.51, 'set': {LEAK: 1e-12},
                  'intermittent': {'period_s': 0.01, 'duty': 0.3}})
    assert found[503] == {OVER: 5e-13}


def test_a_random_one_has_its_duty_in_the_mean_and_is_that_of_its_seed_and_target():
    """Of 4000 periods 0.3 are on, within four standard deviations, 0.029."""
    own = Intermittent(5, 0.3, 7, 'knee')
    ticks = [bool(own.at(5 * cycle, {LEAK: 1.0})) for cycle in range(4000)]
    assert sum(ticks) / 4000 == pytest.approx(0.3, abs=0.029)
    assert [bool(own.at(5 * cycle + 4, {LEAK: 1.0})) for cycle in range(50)] == ticks[:50]
    for other in (Intermittent(5, 0.3, 8, 'knee'), Intermittent(5, 0.3, 7, 'hip')):
        assert [bool(other.at(5 * cycle, {LEAK: 1.0})) for cycle in range(50)] != ticks[:50]
    drawn = [knee({'t_s': 0.1, 'until_s': 0.9, 'set': {LEAK: 1e-12},
                   'intermittent': {'period_s': 0.01, 'duty': 0.5, 'seed': 3}}) for _ in range(2)]
    assert drawn[0] == drawn[1] and 20 < len(drawn[0]) < 70
    assert all(tick % 10 == 0 for tick in drawn[0])


def test_a_named_fault_and_one_of_a_supply_have_courses():
    named, pump = faults(
        {'t_s': 0.1, 'until_s': 0.9, 'actuator': 'knee', 'fault': 'load_cell_stuck',
         'intermittent': {'period_s': 0.1, 'duty': 0.5}},
        {'t_s': 0.1, 'supply': 'pump', 'set': {'pressure_mpa': 10}, 'ramp_s': 0.5})
    assert named.at(100, 1) and not named.at(150, 1)
    assert 10.0 < pump.at(300, 1)['pressure_mpa'] < 20.7


def test_a_scenario_with_courses_is_written_as_it_was_read():
    text = ('name: broken\nduration_s: 1.0\nfaults:\n'
            '- {t_s: 0.5, actuator: knee, set: {plant.sensors.force.bias: 9}, ramp_s: 0.2}\n'
            '- {t_s: 0.5, actuator: knee, fault: valve_stuck, until_s: 0.8,\n'
            '   intermittent: {period_s: 0.02, duty: 0.25}}\n'
            '- {t_s: 0.2, supply: pump, fault: pump_trip, until_s: 0.8,\n'
            '   intermittent: {period_s: 0.02, duty: 0.25, seed: 4}}\n')
    scenario = scenario_of(text, RUN)
    assert scenario_of(scenario.to_yaml(), RUN).faults == scenario.faults
    assert len({type(fault.course) for fault in scenario.faults}) == 2


TWO = {'period_s': 0.01, 'duty': 0.5}


@pytest.mark.parametrize(('tree', 'message'), [
    ({'set': {STUCK: 1}, 'ramp_s': 0.1},
     r'faults\[0\].ramp_s is not used: plant.spool.stuck takes whole numbers only'),
    ({'set': {'plant.sensors.force.delay_ms': 2.0}, 'ramp_s': 0.1},     # at its first step
     r'at 0.5 s, .*plant.sensors.force.delay_ms = 0.02 ms, must be <= 12.7 ms and a multiple of'),
    ({'set': {'reu.protection.mask': 2}, 'until_s': 0.9, 'sine': {
        'amplitude': 1, 'frequency_hz': 2}},    # it began, and ended the run at the second tick
     r'faults\[0\].sine is not used: reu.protection.mask takes whole numbers only'),
    ({'set': {BIAS: 1}, 'ramp_s': 0.0}, r'faults\[0\].ramp_s = 0 s, must be > 0 s; without it'),
    ({'set': {BIAS: 1}, 'ramp_s': 0.0005}, r'faults\[0\].ramp_s = 0.0005 s, must be a multiple'),
    ({'set': {BIAS: 1}, 'intermittent': TWO}, r'faults\[0\] has intermittent: needs until_s'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'ramp_s': 0.1, 'intermittent': TWO},
     r'faults\[0\] has ramp_s and intermittent, must have one of them'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'intermittent': {'duty': 0.5}}, 'lacks period_s'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'intermittent': {**TWO, 'duty': 0.01}},
     r'intermittent.duty = 0.01, must be at least one tick of the 10 ticks'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'intermittent': {**TWO, 'duty': 0.99}}, 'and leave one'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'intermittent': {**TWO, 'duty': 1.0}},
     r'intermittent.duty = 1, must be < 1'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'intermittent': {**TWO, 'seed': -1}},
     r'intermittent.seed = -1, must be a whole number'),
    ({'set': {BIAS: 1}, 'until_s': 0.9, 'intermittent': {**TWO, 'sed': 1}}, 'sed is unknown')])
def test_a_course_that_cannot_be_is_refused_in_one_line(tree, message):
    with pytest.raises(ConfigError, match=message) as refused:
        faults({'t_s': 0.5, 'actuator': 'knee', **tree})
    assert '\n' not in str(refused.value)
