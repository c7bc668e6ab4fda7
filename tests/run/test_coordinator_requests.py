"""What a coordinator is asked between ticks: pause, step, reset, save, another pace."""

import itertools

from isa_ros.errors import ConfigError
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.pacing import Pace
import pytest
from tests.run.rig import Rig


def test_a_paused_run_ticks_only_when_stepped():
    """Paused after a tick, two steps, then on to the end; each recorded where it was done."""
    rig = Rig(5)
    rig.asked = {1: lambda run: run.pause(True), 3: lambda run: run.step(2),
                 5: lambda run: run.pause(False)}
    rig.run()
    assert rig.sequences == [0, 1, 2, 3, 4, 5]
    idles = [k for k, line in enumerate(rig.log) if line == 'idle']
    sends = [k for k, line in enumerate(rig.log) if line.startswith('send')]
    assert [sum(idle < send for idle in idles) for send in sends] == [0, 2, 2, 4, 4]
    assert rig.events == {1: ['pause', 'step 2'], 3: ['resume']}
    assert [line for line in rig.log if line.startswith('event')] == [
        'event pause', 'event step 2', 'event resume']


def test_a_step_is_refused_unless_paused():
    rig = Rig(3)
    rig.asked = {1: lambda run: run.step(1)}
    with pytest.raises(ConfigError, match='step: the run is not paused'):
        rig.run()


def test_a_step_does_not_go_beyond_the_end():
    rig = Rig(3, is_paused=True)
    rig.asked = {0: lambda run: run.step(100)}
    rig.run()
    assert rig.sequences == [0, 1, 2, 3]


def test_a_run_may_begin_paused():
    rig = Rig(2, is_paused=True)
    rig.asked = {3: lambda run: run.pause(False)}
    rig.run()
    assert rig.log.index('send 0 x0=0 kinds=[0, 0]') > rig.log.index('idle')
    assert rig.sequences == [0, 1, 2]


def test_a_stop_ends_a_pause():
    rig = Rig(3, is_paused=True)
    rig.stops_at = 0
    with pytest.raises(Interrupted, match='after 0 ticks'):
        rig.run()
    assert rig.sequences == [0]


def test_a_reset_ends_the_run_where_it_is():
    rig = Rig(9)
    rig.asked = {2: lambda run: run.reset()}
    rig.run()
    assert rig.coordinator.is_reset
    assert rig.sequences == [0, 1, 2]
    assert rig.events == {2: ['reset']}


def test_a_saved_run_goes_on_where_it_was():
    """Tick, load, participants and what controllers asked for; the sample there comes first."""
    first, states = Rig(4), []
    first.transport.asks_at = 1
    first.asked = {2: lambda run: states.append(run.save())}
    first.run()
    again = Rig(4)
    again.run(states[0])
    assert f'restore 2 {[b"b", b"a"]}' in again.log
    assert again.recorder.samples == first.recorder.samples[2:]
    sent = [line for line in first.log if line.startswith('send')][2:]
    assert [line for line in again.log if line.startswith('send')] == sent
    assert sent[0] == 'send 2 x0=2 kinds=[1, 2]'


def test_a_run_that_ends_paused_was_not_behind():
    """However long it was paused: a minute at each look."""
    clock = itertools.count(step=60)
    pace = Pace(1.0, now=lambda: float(next(clock)), sleep=lambda seconds: None)
    rig = Rig(None, pace)
    rig.asked = {2: lambda run: run.pause(True), 5: lambda run: setattr(rig, 'stops_at', 2)}
    with pytest.raises(Interrupted, match='after 2 ticks'):
        rig.run()
    assert rig.log[-2:] == ['idle', 'record 2'] and pace.shortfall is None


def test_another_pace_counts_from_now():
    rig = Rig(2)
    rig.asked = {1: lambda run: run.set_real_time_factor(1e6)}
    rig.run()
    assert rig.sequences == [0, 1, 2]
    with pytest.raises(ConfigError, match='real_time_factor = -1'):
        rig.coordinator.set_real_time_factor(-1.0)
