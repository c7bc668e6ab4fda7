"""One run on ROS nodes: actuators in processes of their own, or all in this one."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import gc

from isa_ros.nodes.actuator.node import ActuatorNode, Setup
from isa_ros.nodes.actuator.process import run
from isa_ros.nodes.coordinator.node import CoordinatorNode
from isa_ros.nodes.coordinator.services import RunServices
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.expected import Cast, Expected, Limits
from isa_ros.nodes.lockstep.mixed_transport import MixedTransport
from isa_ros.nodes.middleware.domain import look_for_other_coordinator, sole_coordinator
from isa_ros.nodes.middleware.environment import defaults
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.processes.processes import actuator_processes, Children
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.exchange import Transport
from isa_ros.run.group import ActuatorGroup, state_messages
from isa_ros.run.in_process import LocalTransport
from isa_ros.run.session import record, Report, save_in_bag, Session
from isa_ros.run.warm_up import warmed_up
from isa_ros.surroundings.surroundings import SharedLoad
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import try_shutdown

_QUIET = {
    'use_global_arguments': False, 'enable_rosout': False,
    'parameter_overrides': [Parameter('start_type_description_service', value=False)],
}
"""Nodes of a bring-up have nothing a user could set from outside."""


def in_processes(session: Session, report: Report | None, should_stop: StopRequest) -> None:
    """Start one process per actuator, coordinate them from here, and end them."""
    load = SharedLoad(session.run)
    cast = _cast(session, load)
    request = session.request
    processes = actuator_processes(
        session.run, request.config, request.scenario, session.run.names_here(request.elsewhere))
    children = Children(
        processes, request.namespace, _work if request.is_alone else None)
    with defaults(), sole_coordinator(), children:
        _settle(session)
        with _node(request.namespace) as node:
            _coordinate(node, session, load, cast, report, should_stop, children.lost)


def _settle(session: Session) -> None:
    """Spare the collector what is loaded by now, which halts a run for 60 ms once or twice."""
    if session.request.is_alone:
        gc.freeze()


def _work(arguments: Sequence[str]) -> int:
    return run(arguments, '')


def in_one_process(session: Session, report: Report | None, should_stop: StopRequest) -> None:
    """Call the nodes of all actuators from here."""
    with defaults(), sole_coordinator(), _node(session.request.namespace) as node:
        coordinate_locally(node, session, report, should_stop)


@contextmanager
def _node(namespace: str) -> Iterator[CoordinatorNode]:
    with refusals():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = CoordinatorNode(namespace=namespace, **_QUIET)
        try:
            yield node
        finally:
            node.destroy_node()
    finally:
        try_shutdown()


def coordinate(
        node: CoordinatorNode, session: Session, report: Report | None,
        should_stop: StopRequest) -> None:
    """Run with participants that someone else starts."""
    load = SharedLoad(session.run)
    cast = _cast(session, load)
    _settle(session)
    _coordinate(node, session, load, cast, report, should_stop, _nobody)


def _nobody() -> None:
    """Know nothing of the participants' processes."""


def _cast(session: Session, load: SharedLoad) -> Cast:
    """
    Return the participants with the digests they must have.

    The kernels are compiled by then, which not every child shall do at once.
    """
    run = session.run
    actuators = [Expected(config.name, stepped.digest)
                 for config, stepped in zip(run.actuators, warmed_up(run))]
    return Cast(
        [*actuators, *_controllers(session)], load.starts(run), run.step_ns,
        states=state_messages(run.actuators))


def _controllers(session: Session) -> list[Expected]:
    return [Expected(name, '') for name in session.run.controllers]


def _coordinate(
        node: CoordinatorNode, session: Session, load: SharedLoad, cast: Cast,
        report: Report | None, should_stop: StopRequest,
        lost: Callable[[], str | None]) -> None:
    node.advertise(load.topics)
    transport = _lockstep(node, session, cast, should_stop, lost)
    try:
        _record(node, session, transport, load, report, should_stop)
    finally:
        transport.close()


def _lockstep(
        node: CoordinatorNode, session: Session, cast: Cast, should_stop: StopRequest,
        lost: Callable[[], str | None]) -> LockstepTransport:
    limits = Limits(session.request.join_timeout_s, session.run.tick_timeout_s)
    return LockstepTransport(node, cast, limits, node, watch=lost, should_stop=should_stop)


def coordinate_locally(
        node: CoordinatorNode, session: Session, report: Report | None,
        should_stop: StopRequest) -> None:
    """Run with the nodes of all actuators in this process; controllers have their own."""
    load = SharedLoad(session.run)
    node.advertise(load.topics)
    configs = session.run.actuators
    warmed_up(session.run)
    _settle(session)
    group = ActuatorGroup(configs, session.timing)
    actuators = [
        ActuatorNode(_resolver(Setup(config, session.timing, member.actuator)), config.name,
                     has_mailbox=False, namespace=session.request.namespace, **_QUIET)
        for config, member in zip(configs, group.members)]
    controllers = None
    try:
        look_for_other_coordinator(node)
        starts = load.starts(session.run)
        transport: Transport
        transport = local = LocalTransport(group, starts, node, actuators)
        if session.run.controllers:
            every = [*(Expected(own.name, '') for own in configs), *_controllers(session)]
            cast = Cast(every, starts, session.run.step_ns, first_remote=len(configs))
            controllers = _lockstep(node, session, cast, should_stop, _nobody)
            transport = MixedTransport(local, controllers)
        _record(node, session, transport, load, report, should_stop)
    finally:
        if controllers is not None:
            controllers.close()
        for actuator in actuators:
            actuator.destroy_node()


def _record(
        node: CoordinatorNode, session: Session, transport: Transport, load: SharedLoad,
        report: Report | None, should_stop: StopRequest) -> None:
    """Record the run, and serve what is asked of it."""
    services = RunServices(
        node, session.pace.factor, lambda coordinator: save_in_bag(session, coordinator))
    record(session, transport, load, report, should_stop, services.serve)


def _resolver(setup: Setup) -> Callable[[Node], Setup]:
    return lambda node: setup
