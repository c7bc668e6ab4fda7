"""Actuators of one process, ticked together."""

from dataclasses import replace
import inspect
import textwrap

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import COMMAND, HAS_SETPOINT, LOAD_PORT, START
from isa_ros.errors import ConfigError, SimulationDiverged
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, setpoint

CONFIGS = [
    *(default_actuator(model, model) for model in MODELS),
    replace(default_actuator('isa_v5', 'at_a_joint'), load=None)]


def ports(tick: int) -> np.ndarray:
    """Return a port of every actuator; the last one's load is shared and moves."""
    rows = np.zeros(len(CONFIGS), LOAD_PORT)
    rows['supply_pressure'] = 20.7e6 - 1e4 * tick
    rows['x0'] = CONFIGS[-1].initial_position + 1e-5 * tick
    rows['v0'], rows['inverse_mass'], rows['a_bias'] = 0.01, 0.02, 0.1
    return rows


def commands(group: ActuatorGroup, tick: int) -> np.ndarray:
    """Return commands for all but the first actuator at some ticks."""
    rows = np.zeros(len(CONFIGS), COMMAND)
    if tick % 7 == 3:
        for k in range(1, len(CONFIGS)):
            rows[k] = setpoint(position=float(group.samples[k]['position']) + 1e-3)
    return rows


def made() -> ActuatorGroup:
    return ActuatorGroup(CONFIGS, DEFAULT_TIMING)


def test_together_they_do_what_each_does_alone():
    """Bit for bit: states, setpoints in between, replies, samples and what was applied."""
    group = made()
    alone = [SmartActuator(config, DEFAULT_TIMING) for config in CONFIGS]
    for tick in range(20):
        given = commands(group, tick)
        for actuator, command in zip(alone, given):
            actuator.accept(command)
        replies = group.advance(ports(tick), given)
        for k, actuator in enumerate(alone):
            actuator.tick(ports(tick)[k])
            assert group.actuators[k].snapshot() == actuator.snapshot()
            assert replies[k].tobytes() == actuator.reply.tobytes()
            assert group.samples[k].tobytes() == actuator.sample.tobytes()
            assert group.applied[k].tobytes() == actuator.memory.applied.tobytes()
        assert (group.applied['kinds'] != 0).tolist() == [
            bool(k and tick % 7 == 3) for k in range(len(CONFIGS))]
    assert group.t_ns == 20 * DEFAULT_TIMING.step_ns


def test_noise_does_not_depend_on_the_grouping():
    """It is that of an actuator's name: alone, together, or together in another order."""
    disturbed = [replace(config, sheet=replace(config.sheet, plant=replace(
        config.sheet.plant, sensors=actuator_sheet(
            config.model, 'default', 'data_sheet_sensors').plant.sensors)))
        for config in CONFIGS]
    timing = replace(DEFAULT_TIMING, seed=7)
    groups = [ActuatorGroup(disturbed, timing), ActuatorGroup(disturbed[::-1], timing),
              *(ActuatorGroup([config], timing) for config in disturbed)]
    for tick in range(5):
        rows = ports(tick)
        groups[0].advance(rows)
        groups[1].advance(rows[::-1].copy())
        for k, alone in enumerate(groups[2:]):
            alone.advance(rows[k:k + 1])
    together = [actuator.snapshot() for actuator in groups[0].actuators]
    assert [actuator.snapshot() for actuator in groups[1].actuators] == together[::-1]
    assert [group.actuators[0].snapshot() for group in groups[2:]] == together
    other = ActuatorGroup(disturbed, DEFAULT_TIMING)
    for tick in range(5):
        other.advance(ports(tick))
    assert all(actuator.snapshot() != own for actuator, own in zip(other.actuators, together))


def test_commands_given_with_the_tick_act_as_if_accepted_before_it():
    """Over what waits already, which a command that brings no gains keeps."""
    given, accepted = made(), made()
    for group in (given, accepted):
        group.actuators[1].accept(setpoint(position=0.9, stiffness=150.0))
    rows = np.zeros(len(CONFIGS), COMMAND)
    rows[1] = setpoint(position=1.0)
    accepted.actuators[1].accept(rows[1])
    given.advance(ports(0), rows)
    accepted.advance(ports(0))
    assert given.snapshot() == accepted.snapshot()
    assert (given.applied[1]['position'], given.applied[1]['stiffness']) == (1.0, 150.0)
    assert rows[1]['kinds'] == HAS_SETPOINT, 'the rows belong to the caller'


def test_without_commands_nothing_is_commanded():
    """As with rows of no kind, also after a tick that had some."""
    silent, empty = made(), made()
    for group, rows in ((silent, None), (empty, np.zeros(len(CONFIGS), COMMAND))):
        group.advance(ports(0), commands(group, 3))
        for tick in range(1, 4):
            group.advance(ports(tick), rows)
    assert silent.snapshot() == empty.snapshot()
    assert not silent.applied['kinds'].any()


def test_parameters_that_changed_are_named_by_row():
    group = made()
    group.actuators[2].tune({'force.kp': 1e-7})
    assert group.tuned == {}
    group.advance(ports(0))
    assert group.tuned == {2: {'force.kp': 1e-7}}
    group.advance(ports(1))
    assert group.tuned == {}


def moved(group: ActuatorGroup, first: int, ticks: int) -> list[bytes]:
    """Return everything the group shows over some ticks."""
    said = []
    for tick in range(first, first + ticks):
        replies = group.advance(ports(tick), commands(group, tick))
        said += [replies.tobytes(), group.samples.tobytes(), group.applied.tobytes()]
    return said


def test_a_restored_group_goes_on_byte_for_byte():
    """Also in an object that never moved, with what was accepted and tuned but not yet taken."""
    group = made()
    moved(group, 0, 10)
    group.actuators[0].accept(setpoint(position=0.02))
    group.actuators[1].tune({'force.kp': 1e-7})
    saved, samples = group.snapshot(), group.samples.tobytes()
    rest = moved(group, 10, 10)
    other = made()
    for again in (group, other):
        again.restore(saved)
        assert again.samples.tobytes() == samples
        assert moved(again, 10, 10) == rest
        assert again.t_ns == 20 * DEFAULT_TIMING.step_ns


def test_a_snapshot_that_is_cut_or_of_other_actuators_is_refused():
    snapshot = made().snapshot()
    with pytest.raises(ConfigError, match=rf'{MODELS[0]}: missing in the saved state'):
        made().restore(b'')
    with pytest.raises(ConfigError, match=r'at_a_joint: saved state has \d+ bytes, must have'):
        made().restore(snapshot[:-1])
    fewer = ActuatorGroup(CONFIGS[:-1], DEFAULT_TIMING)
    with pytest.raises(ConfigError, match='at_a_joint: missing in the saved state'):
        made().restore(fewer.snapshot())
    size = len(fewer.snapshot())
    with pytest.raises(ConfigError, match=rf'state has {len(snapshot)} bytes, must have {size}'):
        fewer.restore(snapshot)


def test_a_started_group_begins_anew_where_its_rows_say():
    """What was commanded and tuned before is forgotten."""
    group, starts = made(), np.zeros(len(CONFIGS), START)
    starts['position'] = [config.initial_position + 1e-4 for config in CONFIGS]
    starts['supply_pressure'] = 20.7e6
    runs = []
    for _ in range(2):
        group.start(starts)
        assert group.replies['position'].tolist() == starts['position'].tolist()
        group.actuators[1].tune({'force.kp': 1e-7})
        runs.append([group.snapshot(), *moved(group, 0, 10)])
    assert runs[0] == runs[1]


def test_the_one_that_diverges_is_named():
    group = made()
    given = ports(0)
    given['supply_pressure'][1] = np.nan
    with pytest.raises(SimulationDiverged, match=rf'^{MODELS[1]}: plant\.\S+ = nan at t = 0.001'):
        group.advance(given)


def test_the_example_of_the_class_runs():
    """Its lines as they stand; the actuators then hold what they are on."""
    text = inspect.getdoc(ActuatorGroup) or ''
    example = text.split('loop::')[1].split('``ports``')[0]
    names: dict[str, object] = {}
    exec(textwrap.dedent(example), names)
    group, replies = names['group'], names['replies']
    assert isinstance(group, ActuatorGroup) and isinstance(replies, np.ndarray)
    assert group.t_ns > 0 and np.isfinite(replies['force']).all()
    assert len(replies) == len(group.actuators) > 0
