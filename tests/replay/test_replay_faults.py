"""Faults of the device replay: what was recorded is enough, to the byte."""

from pathlib import Path
import random

from isa_ros.bag.reader import Bag
from isa_ros.config.models.fault_catalogue import ACTUATOR, common_faults
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.config.text.yaml_text import Tree
from isa_ros.replay.replay import recorded_inputs
from isa_ros.scenario.scenario import idle, load_scenario
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import pytest
from tests.replay.replayed import content, replayed, result_of
from tests.runs import ACCUMULATOR, BUS, hip_and_knee

RUN = hip_and_knee([SupplyConfig('pump', ACCUMULATOR, ('hip', 'knee'))], BUS)
TICKS = 120
FEW, MANY = 2, 100


def drawn(seed: int) -> list[Tree]:
    """Return a schedule of faults of the catalogue, overlapping and of any length."""
    own = random.Random(seed)
    faults: list[Tree] = []
    for name in own.sample(sorted(common_faults()), own.randint(1, 6)):
        of = common_faults()[name].of
        begin = own.randrange(TICKS)
        tree: Tree = {'t_s': begin * 1e-3, 'fault': name,
                      of: own.choice(('hip', 'knee')) if of == ACTUATOR else 'pump'}
        if own.random() < 0.7:
            tree['until_s'] = (begin + own.randint(1, 60)) * 1e-3
        faults.append(tree)
    return faults


def check(seed: int, directory: Path) -> int:
    """Replay one schedule; return the number of recorded changes."""
    scenario = idle(RUN, TICKS * 1e-3).with_faults(drawn(seed))
    bag = result_of(scenario).save(directory / f'{seed}')
    assert replayed(bag, directory / 'again' / f'{seed}') == content(bag), drawn(seed)
    inputs = recorded_inputs(Bag(bag), RUN)
    return sum(map(len, inputs.tuned.values())) + len(inputs.tuned_supplies)


def test_any_schedule_of_faults_replays_byte_for_byte(tmp_path):
    changes = [check(seed, tmp_path) for seed in range(FEW)]
    assert min(changes) > 0


@pytest.mark.long
def test_a_hundred_schedules_of_faults_replay_byte_for_byte(tmp_path):
    changes = [check(seed, tmp_path) for seed in range(MANY)]
    assert min(changes) > 0 and sum(changes) > 3 * MANY


def test_what_is_recorded_is_what_changed_at_its_tick(tmp_path):
    """Begin and end of each fault, of actuators and supplies, and nothing at tick 0."""
    scenario = idle(RUN, 0.1).with_faults([
        {'t_s': 0.02, 'actuator': 'knee', 'fault': 'valve_stuck', 'until_s': 0.05},
        {'t_s': 0.03, 'supply': 'pump', 'fault': 'pump_trip'}])
    inputs = recorded_inputs(Bag(result_of(scenario).save(tmp_path / 'bag')), RUN)
    assert inputs.tuned == {
        'knee': {20: {'plant.spool.stuck': 1.0}, 50: {'plant.spool.stuck': 0.0}}}
    assert inputs.tuned_supplies == {30: {'pump.pump_flow_lpm': 0.0}}


def test_a_setpoint_that_a_frozen_program_does_not_take_replays(tmp_path):
    """It is in no message, so that nothing may count it; those before and behind it are."""
    tree: Tree = {'name': 'frozen', 'duration_s': 0.1, 'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold', 'stiffness': 1e5, 'damping': 4000.0},
        *({'t_s': t_s, 'position': 0.05 + 0.01 * t_s} for t_s in (0.01, 0.04, 0.08))]},
        'faults': [{'t_s': 0.02, 'actuator': 'ram', 'set': {'reu.frozen': 1.0}, 'until_s': 0.06}]}
    run = load('rig_linear', tree)
    result = run.simulate()
    bag = result.save(tmp_path / 'bag')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    assert sorted(recorded_inputs(Bag(bag), run.configuration).commands) == [0, 10, 80]
    assert result['ram.unused_setpoints'][[60, 100]].tolist() == [0.0, 1.0]     # it has tripped


def test_ramps_and_intermittent_faults_replay_and_continue_byte_for_byte(tmp_path):
    """With every value recorded at its tick; a run saved in the middle goes on in it."""
    scenario = idle(RUN, 0.1).with_faults([
        {'t_s': 0.02, 'actuator': 'knee', 'set': {'plant.sensors.force.bias': 500.0},
         'ramp_s': 0.03, 'until_s': 0.07},
        {'t_s': 0.01, 'actuator': 'hip', 'fault': 'load_cell_stuck', 'until_s': 0.09,
         'intermittent': {'period_s': 0.004, 'duty': 0.5, 'seed': 2}},
        {'t_s': 0.03, 'supply': 'pump', 'set': {'pressure_mpa': 12.0}, 'ramp_s': 0.02}])
    bag = result_of(scenario).save(tmp_path / 'bag')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    tuned = recorded_inputs(Bag(bag), RUN).tuned
    assert list(tuned['knee']) == [*range(21, 51), 70]
    assert tuned['knee'][35] == {'plant.sensors.force.bias': pytest.approx(250.0)}
    assert len(tuned['hip']) > 5
    one = Simulation(scenario)
    for _ in range(40):
        one.step()
    two = Simulation(scenario)
    two.restore(one.snapshot())
    for _ in range(60):
        one.step(), two.step()
    assert one.group.samples.tobytes() == two.group.samples.tobytes()


def test_a_value_changed_by_a_program_replays_as_one_of_a_scenario(tmp_path):
    """The same bytes of messages, whether the fault was planned or came from `tune`."""
    planned = idle(RUN, 0.1).with_faults([
        {'t_s': 0.02, 'actuator': 'knee', 'fault': 'valve_stuck'},
        {'t_s': 0.03, 'supply': 'pump', 'fault': 'pump_trip'}])
    one, two = Simulation(planned), Simulation(idle(RUN, 0.1))
    for tick in range(100):
        if tick == 20:
            two.tune('knee', {'plant.spool.stuck': 1})
        if tick == 30:
            two.tune('pump', {'pump_flow_lpm': 0})
        one.step(), two.step()
        assert (one.tuned, one.tuned_supplies) == (two.tuned, two.tuned_supplies)
        assert one.group.samples.tobytes() == two.group.samples.tobytes()
        assert one.surroundings.supplies.tobytes() == two.surroundings.supplies.tobytes()


@pytest.mark.parametrize('saved_at', [20, 25, 30, 31, 55])
def test_a_run_saved_in_a_fault_goes_on_in_it(saved_at):
    """Before, at, in and after each change; the twin is made anew from the bytes."""
    scenario = idle(RUN, 0.1).with_faults([
        {'t_s': 0.02, 'actuator': 'knee', 'fault': 'internal_leak', 'until_s': 0.05},
        {'t_s': 0.03, 'supply': 'pump', 'fault': 'pump_trip', 'until_s': 0.06}])
    first, twin = Simulation(scenario), Simulation(scenario)
    for _ in range(saved_at):
        first.step()
    twin.restore(first.snapshot())
    for _ in range(saved_at, 100):
        first.step(), twin.step()
        assert (twin.tuned, twin.tuned_supplies) == (first.tuned, first.tuned_supplies)
        assert twin.group.samples.tobytes() == first.group.samples.tobytes()
    assert twin.snapshot() == first.snapshot()


def test_a_run_that_begins_again_has_its_faults_again():
    scenario = idle(RUN, 0.1).with_faults([
        {'t_s': 0.02, 'actuator': 'knee', 'fault': 'valve_stuck'},
        {'t_s': 0.03, 'supply': 'pump', 'fault': 'pump_trip'}])
    simulation, states = Simulation(scenario), []
    for _ in range(2):
        simulation.reset()
        for _ in range(60):
            simulation.step()
        states.append(simulation.group.samples.tobytes()
                      + simulation.surroundings.supplies.tobytes())
    assert states[0] == states[1]


def test_a_load_that_is_pushed_grows_and_whose_support_moves_replays(tmp_path):
    """A step, a sine at each tick, another inertia; a support that moves."""
    pushed = load('rig_linear', {'name': 'pushed', 'duration_s': 0.1, 'changes': [
        {'t_s': 0.01, 'actuator': 'ram', 'set': {'load.force': -300.0}, 'until_s': 0.05,
         'sine': {'amplitude': 100.0, 'frequency_hz': 50.0}},
        {'t_s': 0.03, 'actuator': 'ram', 'set': {'load.inertia': 80.0}, 'until_s': 0.08}]})
    moved = load(pushed.replace({'actuators.ram.load': {'kind': 'blocked'}})._config.tree, {
        'name': 'moved', 'duration_s': 0.1, 'changes': [
            {'t_s': 0.02, 'actuator': 'ram', 'set': {'load.displacement': 2e-4}}]})
    for name, run, changes in (('pushed', pushed, 42), ('moved', moved, 1)):
        bag = run.simulate().save(tmp_path / name)
        assert replayed(bag, tmp_path / f'{name} again') == content(bag)
        tuned = recorded_inputs(Bag(bag), run.configuration).tuned['ram']
        assert len(tuned) == changes, sorted(tuned)


def test_levels_and_reactions_that_change_replay(tmp_path):
    """A word in the scenario is its number in the bag; a trip in the run comes from it."""
    own = 'reu.protection.overspeed.'
    run = load('rig_linear', {'name': 'armed', 'duration_s': 0.1, 'tracks': {
        'ram': [{'t_s': 0.0, 'position': 0.09}]}, 'changes': [
        {'t_s': 0.05, 'actuator': 'ram', 'until_s': 0.08, 'set': {
            f'{own}reaction': 'disable', f'{own}trip': 0.05, f'{own}warning': 0.0}},
        {'t_s': 0.07, 'actuator': 'ram', 'set': {'reu.protection.mask': 4}}]})
    result = run.simulate()
    assert [trip.condition for trip in result.trips] == ['overspeed']
    bag = result.save(tmp_path / 'armed')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    tuned = recorded_inputs(Bag(bag), run.configuration).tuned['ram']
    assert tuned == {50: {f'{own}warning': 0.0, f'{own}trip': 0.05, f'{own}reaction': 6.0},
                     70: {'reu.protection.mask': 4.0},
                     80: {f'{own}warning': 0.8, f'{own}trip': 1.1, f'{own}reaction': 1.0}}


def test_a_gain_that_travels_over_a_lossy_link_replays_where_it_was_in_force(tmp_path):
    """In the bag is the tick after its frame, two cycles late; a dead link passes none."""
    linked = load('rig_linear').replace({
        'link': {'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 2, 'watchdog_ms': 10.0}})
    run = load(linked._config.tree, {'name': 'tuned', 'duration_s': 0.1, 'changes': [
        {'t_s': 0.02, 'actuator': 'ram', 'set': {'reu.force.kp': 1e-7}, 'until_s': 0.04},
        {'t_s': 0.06, 'actuator': 'ram', 'set': {'link.loss': 1.0}, 'until_s': 0.09},
        {'t_s': 0.061, 'actuator': 'ram', 'set': {'reu.force.ki': 1e-6}}]})
    kp = run.configuration.actuators[0].sheet.reu.force.kp
    bag = run.simulate().save(tmp_path / 'tuned')
    tuned = recorded_inputs(Bag(bag), run.configuration).tuned['ram']
    assert tuned == {23: {'force.kp': 1e-7}, 43: {'force.kp': kp}, 60: {'link.loss': 1.0},
                     90: {'link.loss': 0.0}}
    assert replayed(bag, tmp_path / 'again') == content(bag)


def test_a_link_that_is_lost_for_a_while_replays(tmp_path):
    """Without a frame the sample that listeners have grows old; afterwards it is young again."""
    link = {'kind': 'can', 'cycle_ms': 1.0, 'delay_cycles': 1, 'watchdog_ms': 20.0}
    run = load({
        'name': 'ram', 'step_ms': 1.0, 'controller_offset_ms': 0.12, 'tick_timeout_s': 5.0,
        'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
        'actuators': {'ram': {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'link': link}}})
    result = run.simulate(0.1, faults=[
        {'t_s': 0.04, 'link': 'ram', 'set': {'loss': 1.0}, 'until_s': 0.06}])
    age = result['ram.link.age']
    assert age[40:61].max() > 0.015 > 0.005 > max(age[20:40].max(), age[70:].max())
    bag = result.save(tmp_path / 'bag')
    inputs = recorded_inputs(Bag(bag), run.configuration)
    assert inputs.tuned == {'ram': {40: {'link.loss': 1.0}, 60: {'link.loss': 0.0}}}
    assert replayed(bag, tmp_path / 'again' / 'bag') == content(bag)


def test_the_shipped_scenario_of_faults_replays(tmp_path):
    run = load_run(find('leg.yaml', CONFIG))
    scenario = load_scenario(find('device_faults.yaml', SCENARIOS), run)
    bag = result_of(scenario).save(tmp_path / 'bag')
    assert len(recorded_inputs(Bag(bag), run).tuned['kfe']) == 4
    assert replayed(bag, tmp_path / 'again' / 'bag') == content(bag)


def test_bursts_duplicates_and_frames_out_of_order_replay(tmp_path):
    """They follow from the seed; another seed has others."""
    run = load('rig_linear', {'name': 'rough', 'duration_s': 0.2, 'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold', 'sine': {'amplitude': 0.01, 'frequency_hz': 5.0}}]}}
               ).replace({'link': {
                   'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 2, 'burst_loss': 0.2,
                   'burst_frames': 4.0, 'duplicates': 0.2, 'reordered': 0.2}})
    result = run.simulate()
    assert result['ram.link.age'].max() > 0.004
    bag = result.save(tmp_path / 'rough')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    other = run.simulate(seed=7)
    assert (other['ram.link.age'] != result['ram.link.age']).any()
