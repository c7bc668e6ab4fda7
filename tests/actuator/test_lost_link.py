"""A link that is lost: its watchdog, its trip, and what an actuator answers behind it."""

from isa_ros.actuator import link as links
from isa_ros.actuator.link import link_record, LINK_STATE
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.record import rows_of
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_QUICK_STOP, HAS_SETPOINT
from isa_ros.reu.cascade import REU_STATE
import numpy as np
import pytest
from tests.actuator.linked import actuator, link_of, linked
from tests.sheets import setpoint


def test_the_watchdog_trips_at_its_step_and_recovers_with_the_next_frame():
    """Frames to 10 ms, then none: lost 3.5 ms later, at step 500 + 175; back at 20 ms."""
    own = actuator(linked(watchdog_ms=3.5))
    link, states = own.memory.constants['link'], []
    for k in range(25):
        link['loss'] = 1.0 if 11 <= k < 20 else 0.0
        own.tick()
        states.append((int(own.memory.reu['link_lost'][0]),
                       int(own.memory.reu['link_lost_step'][0])))
    assert states[:13] == [(0, 0)] * 13
    assert states[13:20] == [(1, 675)] * 7
    assert states[20:] == [(0, 675)] * 5


def test_the_watchdog_is_exact_within_a_plant_step():
    link, reu = link_record(link_of(watchdog_ms=3.5)), rows_of(1, REU_STATE)[0]
    state = rows_of(1, LINK_STATE)[0]
    state.last_frame = 500
    for watch in (links.watch, links.watch.py_func):
        for step, is_lost in ((674, 0), (675, 1), (800, 1)):
            watch(step, link, state, reu)
            assert (reu.link_lost, reu.link_lost_step) == (is_lost, 675 * is_lost)
        state.last_frame = 801
        watch(801, link, state, reu)
        assert reu.link_lost == 0
        state.last_frame, reu.link_lost_step = 500, 0


def test_a_lost_link_trips_until_the_next_frame():
    """
    Frames to 10 ms, the watchdog at 13.5 ms: it stops, though frames come again, until it stands.

    Then it goes on to its setpoint with 0.1 m/s. The REU looks at its conversions, every 5 plant
    steps from step 1 on: the first later than step 675 is 676.
    """
    own = actuator(linked(watchdog_ms=3.5))
    link = own.memory.constants['link']
    own.accept(setpoint(position=0.06))
    trips = []
    for k in range(25):
        link['loss'] = 1.0 if 11 <= k < 20 else 0.0
        own.tick()
        trips.append(conditions(own.sample.trips))
    assert trips == [[]] * 13 + [['link_lost']] * 7 + [[]] * 5
    protection = own.memory.reu['protection'][0]
    assert protection['trip_since'][BITS['link_lost']] == 676
    for _ in range(60):
        own.tick()
        assert own.sample.position < 0.053
    assert not own.memory.reu['status'][0]['is_stopping']
    for _ in range(120):
        before = float(own.sample.position_reference)
        own.tick()
        assert own.sample.position_reference - before < 1.001e-4  # 0.1 m/s for a tick of 1 ms
    assert own.sample.position_reference == 0.06


def test_a_link_without_watchdog_is_never_lost():
    own = actuator(linked(loss=1.0))
    for _ in range(20):
        own.tick()
    assert own.memory.reu['link_lost'][0] == 0


DEAD = {'link.loss': 1.0}


def asked(kinds: int, is_enabled: int = 0) -> np.void:
    command: np.void = np.zeros(1, COMMAND)[0]
    command['kinds'], command['is_enabled'] = kinds, is_enabled
    return command


def test_a_dead_link_answers_no_success_and_its_old_commands_do_not_act():
    """The quick stop of a broken cable does not come 100 ms after it is mended."""
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=10.0))
    for _ in range(20):
        own.tick()
    done, answer = own.request(asked(HAS_ENABLE, 1), 'enabled')
    assert done and answer.startswith('enabled: handed to the link at t = 0.020000 s')
    own.tick()
    own.tick()
    own.tune(DEAD)
    for _ in range(12):
        own.tick()
    state, observed = own.memory.reu[0]['status']['state'], own.memory.observed[0]
    assert observed['is_stale'] == 1.0 and observed['age'] >= 0.01
    done, answer = own.request(asked(HAS_QUICK_STOP), 'quick stop')
    assert not done and answer.startswith('quick stop: the link is lost: the last sample is 0.01')
    for _ in range(11):
        own.tick()
    assert observed['commands_dropped'] == 1.0 and own.memory.outbox[0]['kinds'] == 0
    own.tune({'link.loss': 0.0})
    for _ in range(20):
        own.tick()
    assert own.memory.reu[0]['status']['state'] == state, 'no quick stop'
    assert observed['is_stale'] == 0.0 and observed['age'] < 0.01


@pytest.mark.parametrize('fresh', [True, False])
def test_a_fresh_setpoint_survives_where_an_old_request_is_dropped(fresh):
    """Each has its own age: a setpoint every tick does not carry an old quick stop along."""
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=10.0))
    own.tune(DEAD)
    own.accept(asked(HAS_QUICK_STOP))
    for k in range(15):
        if fresh or k == 0:
            own.accept(setpoint(position=0.05))
        own.tick()
    assert int(own.memory.outbox[0]['kinds']) == (HAS_SETPOINT if fresh else 0)
    assert own.memory.observed[0]['commands_dropped'] == (1.0 if fresh else 2.0)


def test_without_a_watchdog_a_command_waits_as_long_as_it_takes():
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=0.0))
    own.tune(DEAD)
    own.accept(asked(HAS_QUICK_STOP))
    for _ in range(40):
        own.tick()
    assert int(own.memory.outbox[0]['kinds']) == HAS_QUICK_STOP
    assert own.memory.observed[0]['is_stale'] == 1.0, 'older than ten cycles'


def test_lost_frames_are_counted_each_way():
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, loss=0.3))
    for _ in range(200):
        own.tick()
    link, observed = own.memory.links[0], own.memory.observed[0]
    assert 30 < link['up']['lost'] < 90 and 30 < link['down']['lost'] < 90
    assert observed['frames_lost_up'] == link['up']['lost']
    assert 0 <= link['down']['lost'] - observed['frames_lost_down'] < 10


def test_a_frozen_reu_sends_no_frames_and_takes_none():
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=10.0))
    for _ in range(10):
        own.tick()
    own.tune({'reu.frozen': 1.0})
    lost = int(own.memory.links[0]['down']['lost'])
    for _ in range(30):
        own.accept(setpoint(position=0.03))
        own.tick()
    assert own.memory.observed[0]['is_stale'] == 1.0
    assert own.memory.observed[0]['age'] == pytest.approx(0.03, abs=2e-3)
    assert own.memory.links[0]['down']['lost'] > lost + 25
    assert not own.memory.observed[0]['trips'], 'its watchdog has acted, and cannot tell'
    own.tune({'reu.frozen': 0.0})
    for _ in range(4):
        own.tick()
    assert conditions(own.memory.observed[0]['trips']) == ['watchdog']
