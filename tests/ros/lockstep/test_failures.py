"""Participants that fail, are late or lost."""

import threading

from isa_ros.errors import RunError, SetpointError, SimulationDiverged
from isa_ros.nodes.lockstep.expected import Limits
from isa_ros.run.coordinator import Interrupted
import pytest
from tests.ros.lockstep.participants import (
    begin, DEADLINE_S, make_transport, Scripted, spinning, tick)

pytestmark = pytest.mark.ros


def test_what_a_participant_raises_reaches_the_coordinator(observer):
    """After a refusal the participant continues; the coordinator's run ends."""
    stepper = Scripted()
    stepper.fails_at, stepper.error = 1, SetpointError('kfe: no such thing')
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        with pytest.raises(RunError, match='kfe: refused tick 1: kfe: no such thing'):
            tick(transport, 1)


def test_divergence_arrives_with_its_field(observer):
    """The coordinator raises the error that the actuator raised."""
    stepper = Scripted()
    stepper.fails_at = 1
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        with pytest.raises(SimulationDiverged) as raised:
            tick(transport, 1)
    error = raised.value
    assert (error.t_ns, error.field, error.value) == (7_000_000, 'kfe: spool', float('inf'))


def test_late_participant_is_named(observer):
    stepper = Scripted()
    stepper.is_late_at = 1
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, limits=Limits(join_s=DEADLINE_S, tick_s=0.3))
        begin(transport)
        tick(transport, 0)
        with pytest.raises(RunError, match=r'^haa: no answer to tick 1 after 0\.[34] s'):
            tick(transport, 1)


def test_lost_participant_is_named_before_its_timeout(observer):
    stepper, lost = Scripted(), []
    stepper.is_late_at = 0
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, watch=lambda: lost[0] if lost else None)
        begin(transport)
        lost.append('haa: its process 1 was ended by SIGKILL')
        with pytest.raises(RunError, match='SIGKILL in tick 0'):
            tick(transport, 0)


def test_stop_does_not_wait_for_the_timeout(observer):
    stepper, is_stopped = Scripted(), threading.Event()
    stepper.is_late_at = 0
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, should_stop=is_stopped.is_set)
        begin(transport)
        is_stopped.set()
        with pytest.raises(Interrupted, match='tick 0, which haa did not end'):
            tick(transport, 0)
