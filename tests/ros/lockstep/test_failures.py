"""Participants that fail, are late or lost."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import re
import threading

from isa_ros.controller import Controller, Setpoint, State
from isa_ros.errors import RunError, SetpointError, SimulationDiverged
from isa_ros.nodes.lockstep.expected import Limits
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ControllerRole
from isa_ros.run.coordinator import Interrupted
import pytest
from rclpy.context import Context
from rclpy.node import Node
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


class Failing(Controller):
    """Fails at its start, or in a tick."""

    def __init__(self, error: Exception, tick_ns: int | None = None) -> None:
        self.error, self.tick_ns = error, tick_ns

    def start(self, names: Sequence[str]) -> None:
        if self.tick_ns is None:
            raise self.error

    def step(self, state: State) -> dict[str, Setpoint]:
        if state.t_ns == self.tick_ns:
            raise self.error
        return {}


@contextmanager
def alone(context: Context, controller: Controller) -> Iterator[list[Exception]]:
    """Take part as `follower` while the context lasts; return a list of what ends its process."""
    node = Node('follower', context=context, enable_rosout=False, start_parameter_services=False)
    end, is_over, raised = ParticipantEnd(node, ControllerRole(controller)), threading.Event(), []

    def spin() -> None:
        try:
            end.spin(is_over.is_set)
        except ZeroDivisionError as error:
            raised.append(error)
    thread = threading.Thread(target=spin)
    thread.start()
    try:
        yield raised
    finally:
        is_over.set()
        thread.join()
        node.destroy_node()


@pytest.mark.parametrize(('tick_ns', 'refused'), [(None, 'to begin'), (1_000_000, 'tick 1')])
def test_a_defect_of_a_controller_ends_its_process_and_the_run_with_its_place(
        observer, tick_ns, refused):
    """The run ends at once also where it is the start that fails, and not after 30 s."""
    error = ZeroDivisionError('by zero')
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        with alone(observer.context, Failing(error, tick_ns)) as raised:
            transport = make_transport(observer, ['follower'])
            with pytest.raises(RunError) as ended:
                begin(transport)
                tick(transport, 0)
                tick(transport, 1)
    assert raised == [error]
    assert re.fullmatch(
        rf'follower: refused {refused}: ZeroDivisionError: by zero \(test_failures.py:\d+\)',
        str(ended.value))


def test_a_controller_that_refuses_to_start_is_there_for_another_run(observer):
    """An error of the package ends the run alone."""
    controller = Failing(SetpointError('no such leg'))
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        with alone(observer.context, controller) as raised:
            transport = make_transport(observer, ['follower'])
            with pytest.raises(RunError, match='^follower: refused to begin: no such leg$'):
                begin(transport)
            controller.tick_ns = 5_000_000
            begin(transport)
            tick(transport, 0)
    assert raised == []


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
