"""The snapshot of an actuator: no number in it is broken, neither written nor read."""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.saved_state import MAX_TICKS
from isa_ros.errors import ConfigError, SimulationDiverged
import numpy as np
import pytest
from tests.actuator.efforts import run
from tests.sheets import setpoint, smart_actuator, TICK

BROKEN = pytest.mark.parametrize(('path', 'value'), [
    ('body.plant.chambers.p_a', np.nan), ('reu.force.integral', -np.inf), ('port.x0', np.nan),
    ('port.stiffness', np.nan), ('reu.setpoint.damping', np.nan),
    ('pending.position', np.nan), ('pending.stiffness', np.inf), ('applied.effort', np.nan),
    ('reply.mean_forces', np.inf), ('sample.force', np.nan)])
ROWS = {'body': 'continuous', 'reu': 'reu', 'port': 'ports', 'pending': 'pending',
        'applied': 'applied', 'reply': 'replies', 'sample': 'samples'}


def moving() -> SmartActuator:
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    run(actuator, 5)
    return actuator


def broken_at(actuator: SmartActuator, path: str, value: float) -> str:
    """Break a number and return its path as messages show it: rows, then field."""
    rows, *fields = path.split('.')
    at = getattr(actuator.memory, ROWS[rows])[:1]
    for field in fields:
        at = at[field]
    at[...] = value
    return '.'.join(fields)


@BROKEN
def test_a_number_that_is_not_finite_is_not_written(path: str, value: float) -> None:
    actuator = moving()
    field = broken_at(actuator, path, value)
    with pytest.raises(SimulationDiverged) as refused:
        actuator.snapshot()
    rows = path.split('.')[0]
    assert str(refused.value).startswith(f'isa_v5.{rows}: {field} = {value} at t = 0.005')


@BROKEN
def test_a_number_that_is_not_finite_is_not_read(
        path: str, value: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """And the actuator is left as it was."""
    actuator, twin = moving(), moving()
    field = broken_at(actuator, path, value)
    with monkeypatch.context() as unguarded:
        unguarded.setattr('isa_ros.actuator.saved_rows.broken_number', lambda *given: None)
        snapshot = actuator.snapshot()
    before = twin.snapshot()
    with pytest.raises(ConfigError) as refused:
        twin.restore(snapshot)
    rows = path.split('.')[0]
    assert str(refused.value) == (
        f'isa_v5.{rows}: saved state has {field} = {value}, must be finite')
    assert twin.snapshot() == before


def test_a_tuned_value_that_is_not_finite_is_not_read() -> None:
    actuator = moving()
    kp = np.float64(actuator.parameter('force.kp')).tobytes()
    snapshot = actuator.snapshot().replace(kp, np.float64(np.nan).tobytes())
    with pytest.raises(ConfigError, match='isa_v5: saved state has force.kp = nan, must be'):
        actuator.restore(snapshot)


@pytest.mark.parametrize(('value', 'words'), [
    (np.nan, 'force.kp = nan, must be finite'), (-3.0, 'force.kp = -3')])
def test_a_refused_state_leaves_an_actuator_as_it_was(value: float, words: str) -> None:
    """Of another time, with another gain in force: it goes on as if nothing had come."""
    actuator, twin = moving(), moving()
    for own in (actuator, twin):
        own.tune({'force.kp': 1.1e-7})
        run(own, 3)
    other = moving()
    other.tune({'force.kp': 1.5e-7})
    run(other, 40)
    kp = np.float64(1.5e-7).tobytes()
    snapshot = other.snapshot()
    at = snapshot.rindex(kp)    # the last accepted one, behind those in force
    with pytest.raises(ConfigError) as refused:
        actuator.restore(snapshot[:at] + np.float64(value).tobytes() + snapshot[at + 8:])
    assert words in str(refused.value)
    assert actuator.snapshot() == twin.snapshot()
    assert run(actuator, 5) == run(twin, 5)


@pytest.mark.parametrize('t_ns', [1, MAX_TICKS * TICK.step_ns, 2**64 - 1])
def test_a_time_that_is_no_tick_is_not_read(t_ns: int) -> None:
    actuator = moving()
    snapshot = t_ns.to_bytes(8, 'little') + actuator.snapshot()[8:]
    with pytest.raises(ConfigError, match=f'isa_v5: saved state at t = {t_ns} ns, must be'):
        actuator.restore(snapshot)


def test_a_pending_gain_that_keeps_the_one_in_force_is_saved() -> None:
    actuator, twin = moving(), moving()
    actuator.accept(setpoint(position=0.051))
    twin.restore(actuator.snapshot())
    assert run(twin, 5) == run(actuator, 5)
