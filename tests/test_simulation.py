"""The model as an object: a tick, its commands, and where it can begin anew."""

from collections.abc import Mapping
from dataclasses import replace
import json
import math

import isa_ros
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.controller import Setpoint, State
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.errors import ConfigError, RunError, SetpointError, SimulationDiverged
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.scenario.scenario import idle, load_scenario, scenario_of
from isa_ros.simulation import Simulation
import numpy as np
import pytest
from tests.counted import Counter, drop, RUN, shows, stepped
from tests.golden.message_digests import Digests, FILE, SECONDS
from tests.sheets import setpoint

RECORDED = json.loads(FILE.read_text(encoding='utf-8'))


def applied_position(simulation: Simulation, name: str = 'knee') -> float | None:
    """Return the position that took effect at the last tick's start; None: no setpoint did."""
    row = simulation.applied[simulation.names.index(name)]
    return float(row['position']) if row['kinds'] & HAS_SETPOINT else None


@pytest.mark.golden
@pytest.mark.parametrize(('config', 'scenario'), [
    ('leg.yaml', 'drop.yaml'), ('rig_rotary.yaml', 'wheel_sine.yaml'), ('leg.yaml', 'idle')])
def test_its_rows_are_those_of_a_recorded_run(config, scenario):
    """Packed at every tick, they have the digests of the messages of the golden runs."""
    run = load_run(find(config, CONFIG))
    fitted = idle(run) if scenario == 'idle' else load_scenario(find(scenario, SCENARIOS), run)
    simulation = Simulation(fitted)
    packer = packer_of(fitted.run, simulation.loop.rows.published)
    digests = Digests([topic.name for topic in packer.topics])
    simulation.loop.sinks = [RunOutput(packer, fitted.run.step_ns, digests)]
    simulation.loop.begin()
    while simulation.t < SECONDS:
        simulation.step()
    simulation.loop.end()
    assert digests.by_topic() == RECORDED[f'{config} {scenario}']


def test_a_tick_takes_it_one_step_further():
    simulation = Simulation(idle(RUN))
    assert (simulation.ticks, simulation.t_ns, simulation.t) == (0, 0, 0.0)
    for _ in range(3):
        samples = simulation.step()
    assert samples is simulation.samples
    assert (simulation.ticks, simulation.t_ns, simulation.t) == (3, 3_000_000, 0.003)
    assert list(samples) == ['hip', 'knee'] == list(simulation.names)
    assert samples['knee'].position == simulation.group.samples['position'][1]


def test_supplies_and_body_are_shown_by_name():
    """A run without a body shows none."""
    simulation = Simulation(idle(RUN))
    simulation.step()
    assert list(simulation.supply_samples) == ['constant', 'pump']
    assert simulation.supply_samples['constant'].pressure == 20.7e6
    assert 19e6 < simulation.supply_samples['pump'].pressure < 20.7e6
    assert simulation.body_sample is None
    leg = Simulation(drop())
    assert leg.body_sample.foot_position[2] == pytest.approx(0.1, abs=1e-12)
    for _ in range(300):
        leg.step()
    assert leg.body_sample.foot_position[2] < 0.05


def test_reset_begins_anew():
    """Scenario, supplies, body, controllers, and what was commanded but not in force yet."""
    controller = Counter('kfe', 0.05)
    simulation = Simulation(drop(), [controller])
    first = [shows(simulation), *stepped(simulation, 150)]
    simulation.command('haa', position=0.5)
    samples = simulation.samples
    assert simulation.reset() is samples
    assert simulation.ticks == 0
    assert [shows(simulation), *stepped(simulation, 150)] == first
    assert controller.starts == [['haa', 'hfe', 'kfe']] * 2


def test_reset_with_a_seed_is_a_run_with_this_seed():
    """As a new simulation has it; the controllers begin anew too."""
    noisy = isa_ros.load('rig_rotary').replace(
        {'actuators.rotor.variants': ['data_sheet_sensors']})
    simulation = noisy.simulation([Counter('rotor', 0.05)])
    first = [shows(simulation), *stepped(simulation, 20)]
    fresh = noisy.replace({'seed': 4}).simulation([Counter('rotor', 0.05)])
    samples = simulation.reset(seed=4)
    assert samples is simulation.samples and simulation.scenario.run.seed == 4
    second = [shows(simulation), *stepped(simulation, 20)]
    assert second == [shows(fresh), *stepped(fresh, 20)] != first
    assert simulation.snapshot() == fresh.snapshot()
    with pytest.raises(ConfigError, match='seed = -1, must be a whole number >= 0'):
        simulation.reset(seed=-1)


def test_what_a_controller_asked_for_before_a_reset_is_forgotten():
    """Nothing takes effect at the first tick, at which it is shown t = 0."""
    simulation = Simulation(idle(RUN), [Counter('knee', 0.05)])
    for _ in range(2):
        taken = []
        for _ in range(3):
            simulation.step()
            taken.append(applied_position(simulation))
        assert taken == [None, 0.05 + 1e-4, 0.05 + 1e-4 * 2]
        simulation.reset()


def test_what_was_tuned_is_in_force_from_the_first_tick_after_a_reset():
    """As the parameters of a node stay set."""
    simulation = Simulation(idle(RUN))
    simulation.group.actuators[1].tune({'force.kp': 1e-7})
    first = stepped(simulation, 5)
    simulation.reset()
    assert simulation.tuned == {}
    assert stepped(simulation, 5) == first


def test_a_command_takes_effect_at_the_next_tick_once():
    simulation = Simulation(idle(RUN))
    simulation.step()
    simulation.command('knee', position=0.06, stiffness=2e5, is_enabled=True)
    assert applied_position(simulation) is None
    simulation.step()
    knee = simulation.applied[1]
    assert (knee['position'], knee['stiffness'], knee['is_enabled']) == (0.06, 2e5, 1)
    assert math.isfinite(knee['damping'])  # the one in force
    assert applied_position(simulation, 'hip') is None
    simulation.step()
    assert applied_position(simulation) is None
    for _ in range(500):
        simulation.step()
    # within the deflection of a stiff spring under the friction of the seals
    assert simulation.samples['knee'].position == pytest.approx(0.06, abs=1e-3)


@pytest.mark.parametrize(('name', 'setpoint', 'message'), [
    ('elbow', {'position': 0.0}, "'elbow' is not an actuator of the run; valid: hip, knee"),
    ('knee', {'position': math.nan}, 'knee: setpoint position = nan, must be finite'),
    ('knee', {'position': 0.0, 'damping': -1.0}, 'knee: setpoint damping = -1.0, must be >= 0'),
    ('knee', {'position': 50.0}, 'knee: setpoint position = 50 m, must be 0 to 0.1 m, the str')])
def test_a_command_that_cannot_be_is_refused(name, setpoint, message):
    """And changes nothing."""
    simulation, untouched = Simulation(idle(RUN)), Simulation(idle(RUN))
    with pytest.raises(SetpointError, match=message):
        simulation.command(name, **setpoint)
    assert stepped(simulation, 2) == stepped(untouched, 2)


def test_in_mode_force_an_effort_needs_no_position_and_gains_none_either():
    """The force follows; back in impedance the setpoint is where the rod was."""
    simulation = isa_ros.load('rig_linear').replace({
        'actuators.ram.load': {'kind': 'blocked'}}).simulation()
    with pytest.raises(SetpointError, match='position is missing or NaN, must be given in'):
        simulation.command('ram', effort=500.0)
    simulation.command('ram', mode='force')
    simulation.command('ram', effort=500.0)
    for _ in range(200):
        simulation.step()
    # a code of the load cell is 8 N
    assert simulation.samples['ram'].force == pytest.approx(500.0, abs=10.0)
    position = simulation.samples['ram'].position_reference
    simulation.command('ram', stiffness=2e4, damping=900.0)
    simulation.step()
    applied = simulation.applied[0]
    assert (applied['stiffness'], applied['damping'], applied['effort']) == (2e4, 900.0, 500.0)
    assert applied['position'] == position == pytest.approx(0.05, abs=1e-3)
    with pytest.raises(SetpointError, match='stiffness = 1e[+]12 N/m, must be 0 to'):
        simulation.command('ram', stiffness=1e12)


def test_a_command_beyond_the_range_is_limited_with_a_warning_where_configured():
    limited = replace(RUN, actuators=tuple(
        replace(own, beyond_range='limit') for own in RUN.actuators))
    with pytest.warns(UserWarning, match='knee: setpoint position = 50 m, limited to') as caught:
        Simulation(idle(limited)).command('knee', position=50.0)
    assert caught[0].filename == __file__


def test_a_controller_asks_at_tick_k_for_tick_k_plus_1():
    """It is shown the state before the tick, as a run on nodes shows it."""
    controller = Counter()
    simulation = Simulation(idle(RUN), [controller])
    known, taken = [], []
    for _ in range(4):
        known.append((
            simulation.t_ns, [float(own.position) for own in simulation.samples.values()],
            [float(own.pressure) for own in simulation.supply_samples.values()]))
        simulation.step()
        taken.append(applied_position(simulation))
    assert controller.starts[-1] == ['hip', 'knee']
    assert controller.shown == known
    assert taken == [None, 1e-4, 1e-4 * 2, 1e-4 * 3]


class InMillimetres(Counter):
    """Asks for millimetres in tick 1 and 2, otherwise for metres."""

    def step(self, state: State) -> Mapping[str, Setpoint]:
        asked = super().step(state)
        if self.count not in (2, 3):
            return asked
        return {self.name: Setpoint(1e3 * asked[self.name].position + 50.0)}


@pytest.mark.parametrize(('beyond', 'says', 'taken'), [
    (None, 'refused: knee: setpoint position = 50.2 m, must be 0 to 0.1 m, the stroke', None),
    ('limit', 'knee: setpoint position = 50.2 m, limited to 0.1 m, the stroke', 0.1)])
def test_a_request_beyond_the_range_is_refused_or_limited_with_a_warning(beyond, says, taken):
    """The first one is reported; without a request the actuator keeps its setpoint."""
    run = replace(RUN, actuators=tuple(
        replace(own, beyond_range=beyond) for own in RUN.actuators))
    simulation, applied = Simulation(idle(run), [InMillimetres()]), []
    with pytest.warns(UserWarning, match=says) as caught:
        for _ in range(5):
            simulation.step()
            applied.append(applied_position(simulation))
    assert [str(warning.message)[:11] for warning in caught] == ['t = 0.002 s']
    assert caught[0].filename == __file__
    assert applied == [None, 1e-4, taken, taken, 4e-4]


def test_a_setpoint_for_an_unknown_actuator_ends_the_tick():
    simulation = Simulation(idle(RUN), [Counter('elbow')])
    with pytest.raises(RunError, match="'elbow' is not an actuator of the run"):
        simulation.step()


def test_of_two_controllers_the_later_wins_where_both_ask():
    simulation = Simulation(idle(RUN), [Counter('knee'), Counter('hip'), Counter('knee', 0.05)])
    simulation.step()
    simulation.step()
    assert applied_position(simulation) == 0.05 + 1e-4
    assert applied_position(simulation, 'hip') == 1e-4


SCENARIO = scenario_of(
    'name: test\nduration_s: 1.0\ntracks:\n  knee:\n  - {t_s: 0.002, position: 0.07}\n', RUN)


@pytest.mark.parametrize(('scenario', 'controllers', 'expected'), [
    (SCENARIO, [Counter('knee', 0.05)], 0.07), (SCENARIO, [], 0.07),
    (idle(RUN), [Counter('knee', 0.05)], 0.05 + 1e-4 * 2), (idle(RUN), [], 0.03)],
    ids=['all three', 'scenario over command', 'controller over command', 'command'])
def test_the_scenario_wins_over_a_controller_and_both_over_a_command(
        scenario, controllers, expected):
    """At the tick that begins at 2 ms, for which all of them ask."""
    simulation = Simulation(scenario, controllers)
    stepped(simulation, 2)
    simulation.command('knee', position=0.03)
    simulation.step()
    assert applied_position(simulation) == expected


def rows_for(name: str, position: float) -> np.ndarray:
    """Return commands of one actuator alone."""
    rows = np.zeros(2, COMMAND)
    rows[RUN.index(name)] = setpoint(position=position)
    return rows


def test_given_commands_stand_in_the_place_of_the_scenario_s():
    """They win over a controller where both ask, and it is heard where they say nothing."""
    simulation = Simulation(SCENARIO, [Counter('knee', 0.05), Counter('hip', 0.5)])
    stepped(simulation, 2)
    simulation.step(rows_for('knee', 0.06))
    assert applied_position(simulation) == 0.06
    assert applied_position(simulation, 'hip') == 0.5 + 1e-4 * 2
    simulation.step(rows_for('hip', 0.6))
    assert applied_position(simulation) == 0.05 + 1e-4 * 3
    assert applied_position(simulation, 'hip') == 0.6
    alone = Simulation(SCENARIO)
    stepped(alone, 2)
    alone.step(np.zeros(2, COMMAND))
    assert applied_position(alone) is None


def test_parameters_that_changed_are_shown_at_their_tick():
    simulation = Simulation(idle(RUN))
    simulation.group.actuators[1].tune({'force.kp': 1e-7})
    simulation.step()
    assert simulation.tuned == {1: {'force.kp': 1e-7}}
    simulation.step()
    assert simulation.tuned == {}


def test_a_state_that_is_not_finite_ends_the_tick_by_name():
    simulation = Simulation(idle(RUN))
    simulation.group.actuators[1].memory.continuous['plant']['chambers']['p_a'][0] = math.nan
    with pytest.raises(SimulationDiverged, match=r'^knee: plant\.\S+ = nan at t = 0.001'):
        simulation.step()
