"""Stops bear what they carry and brake what moves, whatever the load, model, mode and wiring."""

from collections.abc import Callable
import math

from isa_ros import conditions
from isa_ros.core.device import DISABLED, ENABLED, QUICK_STOP
from isa_ros.simulation import Simulation
import numpy as np
import pytest
from scripts.measure_stops import accelerate, advance, exact_speed, memory_of, rig, simulation_of
from tests.actuator.test_braking import STIFF


def holds(simulation: Simulation) -> None:
    """Lose the setpoint, whose time is over."""


def quick_stop(simulation: Simulation) -> None:
    simulation.command('ram', quick_stop=True)


@pytest.mark.parametrize(('begin', 'state'), [(quick_stop, QUICK_STOP), (holds, ENABLED)])
@pytest.mark.parametrize('force', [0.0, 3000.0, -4000.0])
def test_a_load_at_rest_is_held(
        force: float, begin: Callable[[Simulation], None], state: int) -> None:
    """Within 0.3 mm for 1 s, and within 0.05 mm of the held place at its end, without a cycle."""
    simulation = simulation_of(rig(force=force, parameters={'reu': {
        'device': {'quick_stop': 'ramp_and_hold'},
        'protection': {'setpoint_timeout_ms': 300.0}}}))
    simulation.command('ram', position=0.05, effort=-force, stiffness=3e5, damping=4000.0)
    advance(simulation, 0.29)
    at = float(simulation.samples['ram'].position)
    begin(simulation)
    rows = advance(simulation, 1.0)
    assert rows[-1, 4] == state
    assert abs(rows[:, 0] - at).max() < 3e-4
    assert rows[-500:, 0].max() - rows[-500:, 0].min() < 3e-5
    assert rows[-500:, 2].max() - rows[-500:, 2].min() < 50.0


def held(mass: float, force: float, begin: Callable[[Simulation], None]) -> np.ndarray:
    """Return the rows of 5 s in which a loaded mass, at rest, is held; the first row is before."""
    simulation = simulation_of(rig(mass=mass, force=force, parameters={'reu': {
        'device': {'quick_stop': 'ramp_and_hold'},
        'protection': {'setpoint_timeout_ms': 300.0}}}))
    simulation.command('ram', position=0.05, effort=-force, stiffness=3e5, damping=4000.0)
    before = advance(simulation, 0.29)[-1:]
    begin(simulation)
    return np.concatenate([before, advance(simulation, 5.0)])


def is_held_for_5_s(rows: np.ndarray) -> bool:
    """Return whether a load stays within 0.3 mm of where it was, and rests in the last second."""
    way, last = rows[:, 0] - rows[0, 0], rows[-5000:]
    return bool(abs(way).max() < 3e-4 and np.ptp(last[:, 0]) < 5e-6 and np.ptp(last[:, 2]) < 50.0)


def test_the_heaviest_load_is_held_for_5_s() -> None:
    assert is_held_for_5_s(held(500.0, -4000.0, quick_stop))


@pytest.mark.long
@pytest.mark.parametrize('begin', [quick_stop, holds])
@pytest.mark.parametrize('force', [3000.0, -4000.0])
@pytest.mark.parametrize('mass', [5.0, 20.0, 50.0, 200.0, 500.0])
def test_every_load_is_held_for_5_s(
        mass: float, force: float, begin: Callable[[Simulation], None]) -> None:
    """A lost link has the same reaction as lost setpoints, `hold`."""
    assert is_held_for_5_s(held(mass, force, begin))


@pytest.mark.parametrize(('leakage', 'is_told'), [(2e-12, False), (1e-11, True)])
def test_a_seal_that_breaks_under_a_held_load_is_made_up_for_or_told(
        leakage: float, is_told: bool) -> None:
    """The fault internal_leak let 3 kN sink by 27 mm in 2 s without a word."""
    simulation = simulation_of(rig(force=3000.0, parameters={'reu': {
        'device': {'quick_stop': 'ramp_and_hold'}}}))
    simulation.command('ram', position=0.05, effort=-3000.0, stiffness=3e5, damping=4000.0)
    advance(simulation, 0.2)
    quick_stop(simulation)
    at = advance(simulation, 0.2)[-1, 0]
    simulation.tune('ram', {'plant.oil.cross_port_leakage': leakage})
    way = abs(advance(simulation, 2.0)[:, 0] - at)
    assert ('position_error' in conditions(simulation.samples['ram'].trips)) is is_told
    assert is_told or way.max() < 6e-3 and way[-1] < 3e-4


def test_a_stop_ends_when_the_load_stands_and_not_when_its_ramp_does() -> None:
    """500 kg still moved by 0.13 m/s when their ramp had ended, and the outputs went off."""
    simulation = simulation_of(rig(mass=500.0, position=0.2, parameters={'reu': {
        'device': {'quick_stop_hold_ms': 0.0}}}))
    simulation.command('ram', **STIFF)
    accelerate(simulation, 0.25)
    quick_stop(simulation)
    rows = advance(simulation, 0.4)
    on, off = rows[rows[:, 4] == QUICK_STOP], rows[rows[:, 4] == DISABLED]
    assert 0.05 < len(on) * 2e-4 < 0.3
    assert abs(off[:, 1]).max() < 0.01
    assert np.ptp(off[:500, 0]) < 5e-4


def test_a_stop_that_holds_is_left_by_enable_only_when_the_load_stands() -> None:
    """At 0.13 m/s it was enabled, and ended 6.6 mm farther."""
    simulation = simulation_of(rig(mass=500.0, position=0.2, parameters={'reu': {
        'device': {'quick_stop': 'ramp_and_hold'}}}))
    simulation.command('ram', **STIFF)
    accelerate(simulation, 0.25)
    quick_stop(simulation)
    rows = advance(simulation, 0.03)
    while rows[-1, 4] == QUICK_STOP and simulation.t < 1.0:
        simulation.command('ram', is_enabled=True)
        rows = advance(simulation, 2e-4)
    assert rows[-1, 4] == ENABLED
    position, speed, force = rows[-1, :3].tolist()
    assert abs(speed) < 0.01
    # It moves until the stiffness has taken over the force at that instant, F / k, and by v / w
    # of its speed, w = sqrt(k / m): 0.93 mm and 0.21 mm.
    moves = abs(force) / STIFF['stiffness'] + abs(speed) * math.sqrt(500.0 / STIFF['stiffness'])
    assert abs(advance(simulation, 0.2)[:, 0] - position).max() < moves < 1.2e-3


def test_setpoints_that_are_back_wait_until_a_hold_has_stopped_the_load() -> None:
    """Then they are approached with the speed of a return, 0.1 m/s."""
    simulation = simulation_of(rig(mass=200.0, position=0.2, parameters={'reu': {
        'protection': {'setpoint_timeout_ms': 60.0}}}))
    simulation.command('ram', **STIFF)
    while not simulation.samples['ram'].trips:
        simulation.step()
    assert exact_speed(memory_of(simulation, 'ram')) > 0.2
    advance(simulation, 0.002)
    simulation.command('ram', **STIFF)
    speeds: list[float] = []
    status = memory_of(simulation, 'ram').reu['status'][0]
    while status['is_stopping']:
        assert not status['is_returning'] and simulation.t < 0.5
        simulation.command('ram', **STIFF)
        speeds.append(abs(advance(simulation, 1e-3)[-1, 1]))
        assert not simulation.samples['ram'].trips
    assert len(speeds) > 30 and speeds[0] > 0.2 > 0.01 > speeds[-1]
    assert status['is_returning'] and simulation.samples['ram'].device_state == ENABLED


def test_a_setpoint_that_moves_faster_than_the_way_back_ends_it_where_it_comes_by() -> None:
    """It was followed at 0.1 m/s for ever; what is left then is less than its own steps."""
    simulation = simulation_of(rig(parameters={'reu': {
        'protection': {'setpoint_timeout_ms': 60.0}}}))
    status = memory_of(simulation, 'ram').reu['status'][0]
    simulation.command('ram', **STIFF | {'position': 0.05})
    advance(simulation, 0.4)
    assert simulation.samples['ram'].trips and status['is_stopping']
    ways = []
    for tick in range(400):     # 30 mm at 2 Hz, 0.38 m/s at most; a setpoint each ms
        place = 0.05 + 0.03 * np.sin(4.0 * np.pi * (1e-3 * tick + 0.1))
        simulation.command('ram', **STIFF | {'position': place})
        advance(simulation, 1e-3)
        if not (status['is_returning'] or status['is_stopping']):
            break
        ways.append(place - float(status['back']['position']))
    assert not simulation.samples['ram'].trips
    assert 50 < len(ways) < 200 and max(ways) > 0.02
    assert abs(ways[-1]) < 8e-4


@pytest.mark.parametrize('force', [3000.0, -4000.0])
@pytest.mark.parametrize(('mode', 'variants'), [
    ('impedance', ()), ('force', ()), ('position', ('position_control',)),
    ('pressure', ('pressure_control',)), ('spool', ()), ('current', ())])
@pytest.mark.parametrize('begins', ['at t = 0', 'by enable'])
def test_the_first_current_is_none_in_every_mode_and_with_every_load(
        begins: str, mode: str, variants: tuple[str, ...], force: float) -> None:
    """Below 0.1 mA; it was 9.6 mA, and with 4 kN 50 kg fell by 50 mm from t = 0 on."""
    config = rig(force=force, variants=variants)
    config['actuators']['ram']['mode'] = mode
    simulation = simulation_of(config, {'actuators.ram.auto_enable': begins == 'at t = 0'})
    if begins == 'by enable':
        advance(simulation, 0.05)
        simulation.command('ram', is_enabled=True)
    at = float(simulation.samples['ram'].position)
    rows = advance(simulation, 0.2)
    assert set(rows[:, 4]) == {ENABLED}
    assert abs(rows[0, 3]) < 1e-4
    # Without a position block it drifts, by leakage and by half a code of the force sensor.
    held = 3e-4 if mode in ('impedance', 'position') else 5e-3
    assert abs(rows[:, 0] - at).max() < held


@pytest.mark.parametrize(('mass', 'force'), [(50.0, -4000.0), (200.0, 3000.0)])
def test_a_hanging_load_is_taken_over_by_enable(mass: float, force: float) -> None:
    """The first step of the current stays below 0.1 mA, and the load moves less than 0.3 mm."""
    simulation = simulation_of(rig(mass=mass, force=force))
    simulation.command('ram', is_enabled=False)
    advance(simulation, 0.1)
    at = float(simulation.samples['ram'].position)
    simulation.command('ram', is_enabled=True)
    rows = advance(simulation, 0.3)
    assert rows[-1, 4] == ENABLED
    assert abs(rows[0, 3]) < 1e-4
    assert abs(rows[:, 0] - at).max() < 5e-4


def test_it_is_enabled_out_of_a_stop_that_holds_without_a_jump() -> None:
    simulation = simulation_of(rig(force=-4000.0, parameters={'reu': {
        'device': {'quick_stop': 'ramp_and_hold'}}}))
    simulation.command('ram', position=0.05, effort=4000.0, stiffness=3e5, damping=4000.0)
    advance(simulation, 0.1)
    quick_stop(simulation)
    before = advance(simulation, 0.3)[-1]
    simulation.command('ram', is_enabled=True)
    rows = advance(simulation, 0.2)
    assert rows[0, 4] == ENABLED
    assert abs(rows[0, 3] - before[3]) < 1e-4
    assert abs(rows[:, 0] - before[0]).max() < 3e-4
