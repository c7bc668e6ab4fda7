"""Many ticks in one call: those of single calls, bit for bit, with a row of states for each."""

from dataclasses import replace
import os
import subprocess
import sys

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.states import STATES
from isa_ros.actuator.timing import Timing
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.signals import COMMAND, HAS_GAINS, HAS_SETPOINT, LOAD_PORT
from isa_ros.errors import SimulationDiverged
from isa_ros.reu.wiring import Off
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, own_load, setpoint

TICK = Timing(step_ns=100_000, controller_offset_ns=20_000)
N = 300
GAIN = 'force.kp'
EFFORT = {'smart_manifold': 17.0, 'isa_v2': 400.0, 'isa_v5': 750.0}


def group(*kinds: str, timing: Timing = TICK) -> ActuatorGroup:
    """Return all models, each on one of its loads in turn, at mid stroke."""
    configs = []
    for k, model in enumerate(MODELS):
        sheet = actuator_sheet(model)
        configs.append(ActuatorConfig(
            model, model, 'default', sheet, own_load(model, kinds[k % len(kinds)]),
            0.5 * sheet.plant.drive.stroke))
    return ActuatorGroup(configs, timing)


def ports(pressure: float = 20.7e6) -> np.ndarray:
    """Return the port of each model."""
    rows = np.zeros(len(MODELS), LOAD_PORT)
    rows['supply_pressure'] = pressure
    return rows


def commands(of: ActuatorGroup, n: int = N) -> np.ndarray:
    """Return setpoints in two of three ticks, and softer gains in one: (n, n_actuators)."""
    rows = np.zeros((n, len(MODELS)), COMMAND)
    rows['kinds'][np.arange(n) % 3 > 0] = HAS_SETPOINT
    rows['stiffness'] = rows['damping'] = np.nan
    rows['position'] = of.samples['position_reference']
    for k, model in enumerate(MODELS):
        rows['effort'][:, k] = EFFORT[model] * np.sin(np.arange(n) / 40.0)
    if n > 50:
        rows['kinds'][50] = HAS_GAINS
        rows['stiffness'][50] = 10.0
    return rows


@pytest.mark.parametrize('kinds', [('blocked',), ('wheel', 'mass', 'blocked')])
def test_many_ticks_are_as_many_calls(kinds):
    """States, samples, replies and what was applied."""
    many, single = group(*kinds), group(*kinds)
    given = commands(many)
    log = many.advance_many(ports(), given)
    assert log.samples.shape == log.states.shape == (N + 1, len(MODELS))
    for tick in range(N + 1):
        assert log.samples[tick].tobytes() == single.samples.tobytes()
        exact = log.states[tick]
        assert (exact['pressure'] == exact['pressure_a'] - exact['pressure_b']).all()
        for name in ('force', 'position', 'velocity'):
            assert exact[name].tobytes() == single.replies[name].tobytes()
        for name in ('position', 'force', 'spool', 'current'):
            reference = f'{name}_reference'
            assert exact[reference].tobytes() == single.samples[reference].tobytes()
        if tick < N:
            single.advance(ports(), given[tick])
    assert many.snapshot() == single.snapshot()
    assert many.t_ns == single.t_ns == N * TICK.step_ns
    assert np.ptp(log.states['force'], axis=0).min() > 1.0  # Nm, N: all of them moved


def test_states_are_those_behind_the_sensors():
    """
    A reading is within half a code; the spool and the pressures are read linearly.

    With a tick as long as the period of the converters, and no offset, the last conversion of a
    tick is at its beginning.
    """
    of = group('blocked', timing=replace(TICK, controller_offset_ns=0))
    log = of.advance_many(ports(), commands(of))
    for k, actuator in enumerate(of.actuators):
        sensors = actuator.memory.constants['plant'][0]['sensors']
        for name, code in (('position', 'encoder'), ('force', 'force_step'),
                           ('pressure_a', 'pressure_step'), ('pressure_b', 'pressure_step'),
                           ('spool', 'spool_step'), ('current', 'current_step')):
            apart = np.abs(log.states[name][:-1, k] - log.samples[name][1:, k])
            # half a code, and the roundings of a value of at most 2e7
            assert apart.max() <= 0.5 * sensors[code] + 1e-8


@pytest.mark.parametrize(('off', 'source'), [
    ((), 'force'), (('force',), 'position'), (('position', 'force'), 'setpoint')])
def test_the_pressure_reference_is_what_the_next_block_outwards_gives(off, source):
    """Figure 7: the force block, without it the position block, without both the setpoint."""
    pressure = actuator_sheet('isa_v5', 'default', 'pressure_control').reu.pressure
    sheet = actuator_sheet('isa_v5')
    sheet = replace(sheet, reu=replace(
        sheet.reu, pressure=pressure, **{name: Off() for name in off}))
    alone = ActuatorGroup([ActuatorConfig(
        'isa_v5', 'isa_v5', 'default', sheet, own_load('isa_v5', 'blocked'), 0.05)], TICK)
    rows = np.array([setpoint(position=0.05, effort=1e3)] * 20).reshape(20, 1)
    log = alone.advance_many(ports()[:1], rows)
    reu = alone.actuators[0].memory.reu[0]
    expected = 1e3 if source == 'setpoint' else reu[source]['output']
    assert log.states['pressure_reference'][-1, 0] == expected != 0.0
    assert log.states['drive'][-1, 0] == reu['drive'] != 0.0


def test_without_a_pressure_block_its_reference_is_0():
    of = group('blocked')
    log = of.advance_many(ports(), commands(of))
    assert log.states['force_reference'].any(axis=0).all()
    assert not log.states['pressure_reference'].any()


def test_a_shorter_call_continues_where_the_one_before_ended():
    whole, parts = group('blocked'), group('blocked')
    given = commands(whole)
    rows = whole.advance_many(ports(), given)
    first, none, second = (parts.advance_many(ports(), given[part]) for part in (
        slice(0, 100), slice(100, 100), slice(100, N)))
    assert none.states.tobytes() == first.states[-1:].tobytes() == second.states[:1].tobytes()
    assert rows.states[100:].tobytes() == second.states.tobytes()
    assert whole.snapshot() == parts.snapshot()


@pytest.mark.parametrize('n', [0, 1, 2])
def test_a_tuned_parameter_is_shown_for_the_tick_in_which_it_changed(n):
    """As `tuned` of single ticks."""
    many, single = group('blocked'), group('blocked')
    for of in (many, single):
        of.actuators[0].tune({GAIN: 1.1 * of.actuators[0].parameter(GAIN)})
    many.advance_many(ports(), commands(many, n))
    for row in commands(single, n):
        single.advance(ports(), row)
    assert many.tuned == single.tuned and bool(many.tuned) == (n == 1)
    assert many.snapshot() == single.snapshot()


def test_samples_can_be_left_out():
    """The states are the same."""
    with_samples, without = group('blocked'), group('blocked')
    given = commands(with_samples)
    log = without.advance_many(ports(), given, with_samples=False)
    assert log.samples.shape == (0, len(MODELS))
    assert log.states.tobytes() == with_samples.advance_many(ports(), given).states.tobytes()
    assert without.samples.tobytes() == with_samples.samples.tobytes()


def test_what_was_accepted_before_takes_effect_in_the_first_tick():
    of = group('blocked')
    of.actuators[2].accept(setpoint(position=0.06))
    log = of.advance_many(ports(), np.zeros((20, len(MODELS)), COMMAND))
    assert log.states['position_reference'][0, 2] != 0.06
    assert (log.states['position_reference'][1:, 2] == 0.06).all()


def test_the_state_that_is_not_finite_is_named_with_its_time():
    """As in a single call of `advance`, after 200 ticks of 100 us."""
    of, single = group('blocked'), group('blocked')
    before = commands(of)[:200]
    broken = ports()
    broken['supply_pressure'][1] = np.nan
    for each in (of, single):
        each.advance_many(ports(), before)
    with pytest.raises(SimulationDiverged) as many:
        of.advance_many(broken, commands(of))
    with pytest.raises(SimulationDiverged, match=r' at t = 0.020100 s') as one:
        single.advance(broken)
    assert str(many.value) == str(one.value)
    assert str(many.value).startswith(f'{MODELS[1]}: plant.')
    assert of.t_ns == single.t_ns == 20_100_000


SCRIPT = """
from tests.actuator.test_many_ticks import commands, group, ports

of = group('blocked')
log = of.advance_many(ports(), commands(of, 20))
print(log.samples.tobytes().hex(), log.states.tobytes().hex(), of.snapshot().hex())
"""


def test_compiled_ticks_equal_their_python_source():
    found = [subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', SCRIPT], check=True, capture_output=True,
        text=True, env=dict(os.environ, NUMBA_DISABLE_JIT=plain)).stdout.split()
        for plain in '01']
    assert len(found[0][1]) == 2 * 21 * len(MODELS) * STATES.itemsize
    assert found[0] == found[1]
