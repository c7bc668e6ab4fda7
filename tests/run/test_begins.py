"""When a count of a device began, by its messages and the commands of a bag."""

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.recording import RecordConfig
from isa_ros.controller import Controller, Setpoint
from isa_ros.core.device import DISABLED, ENABLED, INITIALISING
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_QUICK_STOP, HAS_REFERENCE, HAS_SETPOINT, SAMPLE,
    WAS_REFUSED)
from isa_ros.errors import BagError
from isa_ros.run import begins
from isa_ros.run.begins import begins_of
from isa_ros.run.events import Begin, events_in, History, LARGEST_CAVITY, REQUESTS, SETPOINTS
from isa_ros.run.recorded import history_of
from isa_ros.scripting.run import load
from isa_ros.tick.trips import TripWarning
import numpy as np
import pytest
from tests.bag.golden import rewrite

RIG = load('rig_linear')
RUN = RIG.configuration
NOT_FOLLOWED = 'not followed: not enabled'


def begun(monkeypatch, kinds, *, run=RUN, ticks=(0, 10, 20), **fields):
    """Return the begins of the counts that messages at ``ticks`` have, with commands by tick."""
    samples = np.zeros((len(ticks), 1), SAMPLE)
    samples['device_state'] = DISABLED
    for name, values in fields.items():
        samples[name][:, 0] = values
    monkeypatch.setattr(begins, '_kinds', lambda bag, run, windows: {0: kinds})
    return begins_of(None, run, ticks, samples)


def test_the_first_setpoint_of_a_device_that_is_off_is_the_begin(monkeypatch):
    """At 12; the one at 20, of its message, may have been followed. Gains are no setpoint."""
    kinds = {5: HAS_SETPOINT, 11: HAS_GAINS, 12: HAS_SETPOINT, 14: HAS_REFERENCE,
             20: HAS_SETPOINT, 21: HAS_SETPOINT}
    assert begun(monkeypatch, kinds, unused_setpoints=[0, 0, 2]) == {
        (0, SETPOINTS): Begin(12, 12)}


@pytest.mark.parametrize('count, expected', [(1, Begin(12, 18)), (2, Begin(12, 15)),
                                             (3, Begin(12, 12)), (4, Begin(11, 20))])
def test_a_device_that_may_have_followed_leaves_open_which(monkeypatch, count, expected):
    """Of three setpoints the last ones can be those of the count; more than three cannot be."""
    kinds = dict.fromkeys((12, 15, 18), HAS_SETPOINT)
    assert begun(monkeypatch, kinds, unused_setpoints=[0, 0, count], device_state=ENABLED,
                 last_trip=4) == {(0, SETPOINTS): expected}


def test_a_device_that_never_tripped_followed_as_long_as_it_was_enabled(monkeypatch):
    """At 20 it is no longer; one that initialises may be enabled or not."""
    kinds = dict.fromkeys((12, 15, 20), HAS_SETPOINT)
    assert begun(monkeypatch, kinds, unused_setpoints=[0, 0, 1], device_state=ENABLED) == {
        (0, SETPOINTS): Begin(20, 20)}
    assert begun(monkeypatch, kinds, unused_setpoints=[0, 0, 1], device_state=INITIALISING) == {
        (0, SETPOINTS): Begin(12, 20)}


def test_a_request_before_the_next_message_was_refused(monkeypatch):
    """Else the state would have changed; an enable says itself whether it was."""
    assert begun(monkeypatch, {13: HAS_CLEAR_FAULT, 20: HAS_CLEAR_FAULT},
                 refused_requests=[0, 0, 1]) == {(0, REQUESTS): Begin(13, 13)}
    assert begun(monkeypatch, {13: HAS_ENABLE, 15: HAS_ENABLE | WAS_REFUSED, 20: HAS_QUICK_STOP},
                 refused_requests=[0, 0, 1]) == {(0, REQUESTS): Begin(15, 15)}
    assert begun(monkeypatch, {20: HAS_QUICK_STOP}, refused_requests=[0, 0, 1]) == {
        (0, REQUESTS): Begin(20, 20)}


def test_one_command_may_be_several_requests(monkeypatch):
    """Three refusals at 17 alone, behind a link that hides what the state was."""
    every = HAS_CLEAR_FAULT | HAS_QUICK_STOP | WAS_REFUSED
    assert begun(monkeypatch, {13: HAS_CLEAR_FAULT, 17: every}, refused_requests=[0, 0, 3],
                 age=[0.0, 1e-3, 1e-3]) == {(0, REQUESTS): Begin(13, 17)}


def test_behind_a_link_a_count_may_have_begun_before_the_last_message(monkeypatch):
    """By the age of its sample, here two ticks; and whether it followed is not known."""
    kinds = {9: HAS_SETPOINT, 15: HAS_SETPOINT}
    age = [0.0, 1.5e-3, 1.5e-3]
    assert begun(monkeypatch, kinds, unused_setpoints=[0, 0, 1], age=age) == {
        (0, SETPOINTS): Begin(9, 15)}
    assert begun(monkeypatch, {}, unused_setpoints=[0, 0, 1], age=age) == {
        (0, SETPOINTS): Begin(9, 20)}


def test_with_few_messages_of_devices_the_state_between_them_is_not_known(monkeypatch):
    run = RIG.replace({'record.decimate': {'/*/device': 10, '/diagnostics': 10}}).configuration
    assert isinstance(run.record, RecordConfig)
    kinds = {12: HAS_SETPOINT, 14: HAS_SETPOINT}
    assert begun(monkeypatch, kinds, run=run, unused_setpoints=[0, 0, 1]) == {
        (0, SETPOINTS): Begin(12, 14)}
    known = RIG.replace({'record.decimate': {'/*/device': 10}}).configuration
    assert begun(monkeypatch, kinds, run=known, unused_setpoints=[0, 0, 1]) == {
        (0, SETPOINTS): Begin(12, 12)}


def test_what_is_known_already_has_no_window(monkeypatch):
    """A count at the first message, and one between messages of two ticks in a row."""
    assert begun(monkeypatch, {}, unused_setpoints=[1, 1, 2]) == {}
    assert begun(monkeypatch, {}, ticks=(0, 19, 20), unused_setpoints=[0, 0, 2]) == {}
    assert begun(monkeypatch, {}, ticks=()) == {}


def test_a_cavity_is_told_with_both_bounds(monkeypatch):
    found = begun(monkeypatch, {}, largest_cavity=[0.0, 1e-9, 3e-7])
    assert found == {(0, LARGEST_CAVITY): Begin(11, 20)}
    samples = np.zeros((3, 1), SAMPLE)
    samples['largest_cavity'][2] = 3e-7
    event, = events_in(RUN, History([0, 10, 20], samples, begins=found))
    assert (event.t_s, event.what) == (
        0.02, 'vapour in a chamber, at most 0.3 ml, begun between t = 0.011000 s and '
        't = 0.020000 s')


class Persistent(Controller):
    """Commands the ram at each tick of a second, enabled or not."""

    def step(self, state):
        return {'ram': Setpoint(position=0.05)} if state.t_ns >= 30_000_000 else {}


def test_a_run_and_its_bag_have_the_same_times(tmp_path):
    """Disabled at 0.2 s and enabled at 0.4 s, commanded at each tick; both counts, to the tick."""
    run = load('rig_linear', {'name': 'off', 'duration_s': 0.5, 'tracks': {'ram': [
        {'t_s': 0.2, 'enabled': False}, {'t_s': 0.3, 'clear_fault': True},
        {'t_s': 0.4, 'enabled': True}]}})
    with pytest.warns(TripWarning):
        result = run.simulate(controllers=[Persistent()])
    told = [own for own in result.events if own.kind == 'refused']
    assert [own.t_s for own in told] == [0.201, 0.301]
    assert told[0].what == f'200 setpoints {NOT_FOLLOWED}'
    bag = Bag(result.save(tmp_path / 'bag'))
    assert [own for own in isa_ros.read(bag.path).events if own.kind == 'refused'] == told
    assert [own for own in events_in(run.configuration, history_of(bag, run.configuration))
            if own.kind == 'refused'] == told


def test_a_damaged_command_in_a_window_is_refused_with_its_place(tmp_path):
    run = load('rig_linear', {'name': 'off', 'duration_s': 0.05, 'tracks': {'ram': [
        {'t_s': 0.0, 'enabled': False}, {'t_s': 0.02, 'position': 0.05}]}})
    with pytest.warns(TripWarning):
        bag = Bag(run.simulate().save(tmp_path / 'bag'))
    cut = Bag(rewrite(bag, tmp_path / 'cut', lambda topic, sequence, data: (
        data[:40] if topic == '/ram/applied_setpoint' and sequence == 21 else data)))
    with pytest.raises(BagError, match='/ram/applied_setpoint, tick 21 '):
        history_of(cut, run.configuration)
