"""Steps of the device in a scenario and keys of the run file: what they do and what is refused."""

from dataclasses import replace

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.device import CURRENT, DISABLED, ENABLED, FORCE, IMPEDANCE, QUICK_STOP
from isa_ros.core.signals import COMMAND, HAS_GAINS, HAS_SETPOINT
from isa_ros.errors import ConfigError
from isa_ros.scenario.scenario import idle, scenario_of
from isa_ros.simulation import Simulation
import numpy as np
import pytest

RUN = load_run(find('rig_linear.yaml', CONFIG))
NAME = RUN.actuators[0].name
STEPS = f"""
name: steps
duration_s: 0.06
tracks:
  {NAME}:
  - {{t_s: 0.01, mode: current, current: 0.001}}
  - {{t_s: 0.02, mode: force, position: hold, effort: 100.0}}
  - {{t_s: 0.03, quick_stop: true}}
  - {{t_s: 0.04, enabled: false}}
  - {{t_s: 0.05, clear_fault: true, enabled: true, mode: impedance}}
"""


def scenario(steps: str = STEPS):
    """Return a scenario for the rig."""
    return scenario_of(steps, RUN)


def test_steps_take_effect_at_their_times():
    """State and mode at the end of each first tick."""
    simulation, found = Simulation(scenario()), {}
    while simulation.ticks < 60:
        sample = simulation.step()[NAME]
        found[simulation.ticks - 1] = int(sample.device_state), int(sample.device_mode)
    assert [found[at] for at in (9, 10, 20, 30, 40, 50)] == [
        (ENABLED, IMPEDANCE), (ENABLED, CURRENT), (ENABLED, FORCE), (QUICK_STOP, FORCE),
        (DISABLED, FORCE), (ENABLED, IMPEDANCE)]


def test_the_text_of_a_scenario_has_its_steps():
    """Written and read again they are the same commands."""
    again = scenario(scenario().to_yaml())
    assert again.tracks == scenario().tracks


def test_an_effort_alone_is_a_setpoint_of_mode_force():
    """At the position of the point before, at first the start; a wave of the effort goes on."""
    wave = 'sine: {moves: effort, amplitude: 40.0, frequency_hz: 10.0}'
    track = scenario(f"""
name: forces
duration_s: 0.2
tracks:
  {NAME}:
  - {{t_s: 0.0, mode: force, effort: 100.0}}
  - {{t_s: 0.05, position: 0.031, effort: 50.0}}
  - {{t_s: 0.1, effort: -60.0, {wave}}}
  - {{t_s: 0.15, stiffness: 2.0e+5}}
  - {{t_s: 0.16, spool: 1.0e-5, mode: spool}}
""").tracks[0]
    start = RUN.actuators[0].initial_position
    assert start != 0.031
    assert [own.setpoint and (own.setpoint.position, own.setpoint.effort)
            for own in track.events] == [
        (start, 100.0), (0.031, 50.0), (0.031, -60.0), None, None]
    row = np.zeros(1, COMMAND)[0]
    track.events[2].write(125, RUN.step_ns, row)
    assert (row['kinds'], row['position']) == (HAS_SETPOINT, 0.031)
    assert row['effort'] == pytest.approx(-20.0, rel=1e-12)     # a quarter of its period


def test_gains_alone_keep_the_setpoint():
    """They take effect at their tick alone, and are limited as those of a setpoint."""
    text = 'name: gains\nduration_s: 0.02\ntracks:\n  {}:\n  - {{t_s: 0.01, {}}}\n'
    plan = scenario(text.format(NAME, 'damping: 3000.0'))
    assert scenario(plan.to_yaml()).tracks == plan.tracks
    row = np.zeros(1, COMMAND)[0]
    plan.tracks[0].events[0].write(10, RUN.step_ns, row)
    assert (row['kinds'], row['damping']) == (HAS_GAINS, 3000.0)
    assert np.isnan(row['stiffness'])
    later = np.zeros(1, COMMAND)[0]
    plan.tracks[0].events[0].write(11, RUN.step_ns, later)
    assert later['kinds'] == 0
    simulation = Simulation(plan)
    while simulation.ticks < 20:
        simulation.step()
    limited = replace(RUN, actuators=tuple(
        replace(own, beyond_range='limit') for own in RUN.actuators))
    plan = scenario_of(text.format(NAME, 'stiffness: 1.0e+9'), limited)
    plan.tracks[0].events[0].write(10, RUN.step_ns, row)
    assert 0.0 < row['stiffness'] < 1e9
    assert 'limited to' in plan.limited[0]


@pytest.mark.parametrize(('step', 'message'), [
    ('mode: speed', "mode = 'speed' is unknown; "),
    ('mode: position', 'mode = position: reu.position.kind = impedance, must be pid; possible: '),
    ('spool: 1.0e-5', '.spool is not used: the mode is impedance; set mode: spool'),
    ('mode: current, current: 1.0', '.current = 1 A, must be <= '),
    ('quick_stop: 1', '.quick_stop = 1, must be true or false')])
def test_a_step_that_cannot_be_is_refused(step, message):
    with pytest.raises(ConfigError) as error:
        scenario(f'name: bad\nduration_s: 1.0\ntracks:\n  {NAME}:\n  - {{t_s: 0.0, {step}}}\n')
    assert message in str(error.value)


@pytest.mark.parametrize(('changes', 'state', 'mode'), [
    ({'auto_enable': False}, DISABLED, IMPEDANCE), ({'mode': 'force'}, ENABLED, FORCE)])
def test_the_run_file_says_how_it_starts(changes, state, mode):
    """As keys of the actuator; the resolved text keeps them."""
    run = replace(RUN, actuators=tuple(replace(own, **changes) for own in RUN.actuators))
    assert run_of_text(run.to_yaml()).actuators == run.actuators
    sample = Simulation(idle(run)).step()[NAME]
    assert (sample.device_state, sample.device_mode) == (state, mode)


def test_python_commands_the_device():
    """The words of a setpoint; a request takes effect at the next tick."""
    simulation = Simulation(idle(RUN))
    simulation.step()
    simulation.command(NAME, mode='current', current=1e-3)
    assert simulation.step()[NAME].device_mode == CURRENT
    simulation.command(NAME, quick_stop=True)
    assert simulation.step()[NAME].device_state == QUICK_STOP
    simulation.command(NAME, is_enabled=False)
    assert simulation.step()[NAME].device_state == DISABLED
