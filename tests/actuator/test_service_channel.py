"""Gains and levels behind a link: in force when a frame has brought them, and not before."""

from types import SimpleNamespace

from isa_ros.actuator.frames import SLOTS
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.service_channel import ServiceChannel, travels
from isa_ros.actuator.tunable import changing, GAINS
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.changing_values import ChangingValues
from isa_ros.core.signals import COMMAND, LOAD_PORT
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.actuator.linked import actuator, linked
from tests.sheets import actuator_sheet, own_load, TICK

KP, TRIP, STUCK = 'force.kp', 'reu.protection.overload.trip', 'plant.spool.stuck'
DEAD = 'link.loss'


def in_force(own) -> tuple[float, float]:
    reu = own._constants.reu
    return float(reu.force.kp), float(reu.protection.trip[3])


def changes(own, n: int) -> dict[int, dict[str, float]]:
    """Return what took effect in each of ``n`` ticks."""
    found = {}
    for k in range(n):
        own.tick()
        if own.applied_parameters:
            found[k] = own.applied_parameters
    return found


@pytest.mark.parametrize('delay', [0, 1, 3, 8])
def test_a_gain_is_in_force_at_the_tick_after_its_frame_and_a_fault_at_once(delay):
    """The frame leaves at the start of tick 4 and arrives ``delay`` cycles later, in that tick."""
    own = actuator(linked(delay_cycles=float(delay)))
    first = in_force(own)
    changes(own, 4)
    own.tune({KP: 1.2e-7, TRIP: 0.97, STUCK: 1.0})
    assert own.parameter(KP) == 1.2e-7
    found = changes(own, delay + 1)
    assert found == {0: {STUCK: 1.0}} and in_force(own) == first
    assert changes(own, 3) == {0: {KP: 1.2e-7, TRIP: 0.97}}
    assert in_force(own)[0] == 1.2e-7 and in_force(own)[1] == pytest.approx(9700.0)


def test_values_of_each_tick_arrive_one_after_the_other():
    """Frames of a tick each, three cycles on their way: none waits for the last one."""
    own, values = actuator(linked(delay_cycles=3.0)), [1e-7 + 1e-9 * k for k in range(10)]
    found = {}
    for k in range(20):
        if k < 10:
            own.tune({KP: values[k]})
        own.tick()
        if own.applied_parameters:
            found[k] = own.applied_parameters[KP]
    assert found == {k + 4: value for k, value in enumerate(values)}


def test_a_dead_link_passes_no_gain_and_what_waited_too_long_is_dropped():
    own = actuator(linked(watchdog_ms=20.0))
    changes(own, 2)
    first, kp = in_force(own), own.parameter(KP)
    own.tune({DEAD: 1.0})
    changes(own, 1)
    own.tune({KP: 1.2e-7, TRIP: 0.97})
    assert changes(own, 20) == {}
    assert own.parameter(KP) == 1.2e-7      # it may still arrive
    assert changes(own, 1) == {}
    assert own.parameter(KP) == kp
    own.tune({DEAD: 0.0})
    assert changes(own, 10) == {0: {DEAD: 0.0}} and in_force(own) == first


def test_without_a_watchdog_it_waits_and_the_newest_value_arrives():
    own = actuator(linked())
    own.tune({DEAD: 1.0})
    changes(own, 1)
    for k in range(50):
        own.tune({KP: 1e-7 + 1e-9 * k})
        assert changes(own, 1) == {}
    own.tune({DEAD: 0.0})
    assert changes(own, 5) == {0: {DEAD: 0.0}, 1: {KP: 1e-7 + 1e-9 * 49}}


def test_what_left_before_the_cable_broke_arrives_and_is_the_value_that_stays():
    """The first gain is on its way when the link dies, the second never leaves."""
    own = actuator(linked(delay_cycles=4.0, watchdog_ms=20.0))
    changes(own, 3)
    own.tune({KP: 1.1e-7})
    changes(own, 1)
    own.tune({DEAD: 1.0, KP: 1.2e-7})
    assert changes(own, 30) == {0: {DEAD: 1.0}, 4: {KP: 1.1e-7}}
    assert own.parameter(KP) == 1.1e-7


def test_a_frozen_reu_takes_nothing_until_its_program_runs_again():
    own = actuator(linked())
    own.tune({'reu.frozen': 1.0})
    changes(own, 1)
    for k in range(40):     # more changes than frames have slots
        own.tune({KP: 1e-7 + 1e-9 * k})
        assert changes(own, 1) == {}
    own.tune({'reu.frozen': 0.0})
    assert changes(own, 4) == {0: {'reu.frozen': 0.0}, 1: {KP: 1e-7 + 1e-9 * 39}}


def test_a_fault_on_a_gain_comes_and_ends_by_the_link():
    """It lies over what is tuned, of which the user reads the value beneath only at its end."""
    own = actuator(linked(delay_cycles=1.0))
    kp = own.parameter(KP)
    own.tune({f'+{KP}': 1.2e-7})
    assert changes(own, 4) == {2: {KP: 1.2e-7}}
    own.tune({f'-{KP}': 0.0})
    assert changes(own, 4) == {2: {KP: kp}}


def test_a_fault_on_a_gain_that_a_dead_link_dropped_is_not_sent_again():
    own = actuator(linked(watchdog_ms=20.0))
    own.tune({DEAD: 1.0})
    changes(own, 1)
    own.tune({f'+{KP}': 1.2e-7})
    assert changes(own, 30) == {}
    own.tune({DEAD: 0.0})
    assert changes(own, 10) == {0: {DEAD: 0.0}}


def test_what_a_bag_has_is_in_force_at_once():
    """A replay puts in force what was in force: it has travelled already."""
    own = actuator(linked(delay_cycles=3.0, loss=1.0))
    own.tune({f'={KP}': 1.2e-7})
    assert changes(own, 5) == {0: {KP: 1.2e-7}}


@pytest.mark.parametrize('saved_at', [1, 3, 5, 12])
def test_a_saved_state_has_what_is_on_its_way(saved_at):
    def begun():
        own = actuator(linked(delay_cycles=4.0, loss=0.3, watchdog_ms=20.0))
        return own

    own = begun()
    own.tune({KP: 1.1e-7})
    changes(own, 1)
    own.tune({KP: 1.2e-7})
    changes(own, saved_at)
    twin = begun()
    twin.restore(own.snapshot())
    assert changes(twin, 30) == changes(own, 30)
    assert twin.snapshot() == own.snapshot()


@pytest.mark.parametrize('broken', [np.nan, np.inf])
def test_a_broken_number_on_its_way_is_refused(broken):
    """It would be a gain in force one tick later."""
    own = actuator(linked(delay_cycles=4.0))
    own.tune({KP: 1.2e-7})
    own.tick()
    saved = np.frombuffer(own.snapshot()[8:], float).copy()
    places = np.flatnonzero(saved == 1.2e-7)
    saved[places[-1]] = broken      # behind the values that are accepted
    with pytest.raises(ConfigError, match=rf'^isa_v5: saved state has {KP} = {broken}, must be'):
        own.restore(own.snapshot()[:8] + saved.tobytes())


def test_a_reset_sends_what_was_tuned_again():
    own = actuator(linked(delay_cycles=2.0))
    own.tune({KP: 1.2e-7})
    assert changes(own, 8) == {3: {KP: 1.2e-7}}
    own.tune({KP: 1.3e-7})
    own.tick()
    own.start(0.05, 0.0, 20.7e6, 0.0)
    assert changes(own, 8) == {3: {KP: 1.3e-7}}


def test_many_ticks_in_one_call_are_those_of_single_calls():
    config = ActuatorConfig(
        'knee', 'isa_v5', 'default', linked(delay_cycles=3.0), own_load('isa_v5', 'mass'), 0.05)
    one, many = ActuatorGroup([config], TICK), ActuatorGroup([config], TICK)
    ports, commands = np.zeros(1, LOAD_PORT), np.zeros((12, 1), COMMAND)
    ports['supply_pressure'] = 20.7e6
    for own in (one, many):
        own.actuators[0].tune({KP: 1.2e-7})
    for row in commands:
        one.advance(ports, row)
    many.advance_many(ports, commands)
    assert in_force(many.actuators[0])[0] == 1.2e-7
    assert many.snapshot() == one.snapshot()


def test_of_values_that_arrive_between_two_ticks_the_newest_is_in_force():
    """Two frames on their way, late, and both in the same tick."""
    values = ChangingValues('ram', ['gain'], [0.0])
    down = SimpleNamespace(sent=np.zeros(SLOTS), first=0, count=0)
    state = SimpleNamespace(brought=-1, down=down)
    channel = ServiceChannel(SimpleNamespace(watchdog_ns=0), state, values, np.array([True]))
    values.accept({'gain': 1.0})
    assert not channel.latch(0)
    down.count = 1      # a frame leaves with it at step 0
    values.accept({'gain': 2.0})
    assert not channel.latch(50)
    state.brought = 51
    assert channel.latch(100) and values.in_force == {'gain': 2.0}


def test_a_value_that_is_too_old_does_not_take_a_newer_one_with_it():
    """The first is dropped after 100 steps, the second has 30 more."""
    values = ChangingValues('ram', ['gain'], [0.0])
    down = SimpleNamespace(sent=np.zeros(SLOTS), first=0, count=1)
    state = SimpleNamespace(brought=-1, down=down)
    channel = ServiceChannel(
        SimpleNamespace(watchdog_ns=100 * PLANT_STEP_NS), state, values, np.array([True]))
    for step, value in ((0, 1.0), (50, 2.0)):
        values.accept({'gain': value})
        channel.latch(step)
    channel.latch(120)
    assert values.accepted == {'gain': 2.0}
    channel.latch(150)
    assert values.accepted == {}


def test_what_travels_are_gains_and_levels_of_the_reu():
    """No fault, plant, load or link; gains of a setpoint are in its own frame."""
    known = changing(actuator_sheet('isa_v5'), own_load('isa_v5', 'mass'))
    names = {name for name, goes in zip(known, travels(known)) if goes}
    assert {KP, TRIP, 'reu.protection.mask', 'reu.protection.overload.reaction'} <= names
    assert not names & {*GAINS, STUCK, DEAD, 'load.force', 'reu.frozen'}
    assert set(GAINS) <= set(known)
