"""One run on ROS nodes: one process per actuator, or all actuators in this process."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from isa_ros.actuator.constants import participant_digest
from isa_ros.config.assembly import group_of, surroundings_of, timing_of
from isa_ros.config.text.names import parted, placed
from isa_ros.nodes.actuator import in_lockstep, of_run  # noqa: F401, loaded before forks
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.actuator.process import run
from isa_ros.nodes.coordinator.joint_commands import JointCommands
from isa_ros.nodes.coordinator.node import CoordinatorNode
from isa_ros.nodes.coordinator.parameters import SupplyParameters
from isa_ros.nodes.coordinator.services import RunServices
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.expected import Expected, Limits, Participants
from isa_ros.nodes.lockstep.mixed_transport import MixedTransport
from isa_ros.nodes.lockstep.socket_rounds import warm_up_rounds
from isa_ros.nodes.lockstep.steady_ticks import warm_up_ticks
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.nodes.middleware.discovery import refuse_off
from isa_ros.nodes.middleware.domain import look_for_other_coordinator, sole_coordinator
from isa_ros.nodes.middleware.environment import defaults
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.processes.processes import actuator_processes, Children
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.outlets import Outlet
from isa_ros.run.session import record, Report, save_in_bag, Session
from isa_ros.run.warm_up import warmed_up
from isa_ros.run.wire.roster import Roster
from isa_ros.surroundings.surroundings import Surroundings
from isa_ros.tick.calling import calling
from isa_ros.tick.exchange import Rows, Transport
from isa_ros.tick.in_process import InProcess
from rcl_interfaces.msg import ParameterEvent
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.type_support import check_for_type_support
from rclpy.utilities import try_shutdown

_OPTIONS = {
    'use_global_arguments': False,
    'parameter_overrides': [Parameter('start_type_description_service', value=False)],
}
"""
Of a bring-up's nodes: nothing can be set from outside.

They log on `/rosout`, where who has sent a setpoint finds the reason of a rejection.
"""


def in_processes(session: Session, report: Report | None, should_stop: StopRequest) -> None:
    """Start one process per actuator, coordinate them from this process, and end them."""
    request = session.request
    with defaults(), sole_coordinator(request.namespace):
        _refuse_undiscovered(session, '; or use --in-process')
        surroundings = surroundings_of(session.run)
        participants = _participants(session, surroundings)
        processes = actuator_processes(
            session.run, request.config, request.scenario,
            session.run.names_here(request.elsewhere), request.all_changes)
        check_for_type_support(ParameterEvent)  # loads what all messages need, before a fork
        with Children(
                processes, request.namespace, _work if request.is_alone else None) as children:
            session.freeze_objects()
            with _node(request.namespace) as node:
                _coordinate(node, session, surroundings, participants, report, should_stop,
                            children.lost)


def _refuse_undiscovered(session: Session, otherwise: str = '') -> None:
    names = [actuator.name for actuator in session.run.actuators]
    refuse_off(', '.join([*names, *session.run.controllers]), otherwise)


def _work(arguments: Sequence[str]) -> int:
    return run(arguments, '')


def in_one_process(session: Session, report: Report | None, should_stop: StopRequest) -> None:
    """Run the nodes of all actuators in this process."""
    namespace = session.request.namespace
    with defaults(), sole_coordinator(namespace), _node(namespace) as node:
        coordinate_locally(node, session, report, should_stop)


@contextmanager
def _node(namespace: str) -> Iterator[CoordinatorNode]:
    with refusals():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = CoordinatorNode(namespace=namespace, **_OPTIONS)
        try:
            yield node
        finally:
            node.destroy_node()
    finally:
        try_shutdown()


def coordinate(
        node: CoordinatorNode, session: Session, report: Report | None,
        should_stop: StopRequest) -> None:
    """Run with participants that are started separately."""
    _refuse_undiscovered(session, '; or set in_process:=true')
    surroundings = surroundings_of(session.run)
    participants = _participants(session, surroundings)
    session.freeze_objects()
    _coordinate(node, session, surroundings, participants, report, should_stop, _none_lost)


def _none_lost() -> None:
    """Return None: the participants are not child processes."""


def _participants(
        session: Session, surroundings: Surroundings, *, are_here: bool = False) -> Participants:
    """
    Return the participants, with the digests that the actuators must have.

    This compiles the kernels, so that not every child process does at the same time.
    """
    run, timing = session.run, timing_of(session.run)
    actuators = warmed_up(run)
    if not are_here:
        warm_up_ticks(actuators[0])
        warm_up_rounds(Rows(len(actuators), surroundings))
    expected = [
        Expected(own.name, '' if are_here else participant_digest(own.digest, timing))
        for own in actuators]
    expected += [Expected(name, '') for name in run.controllers]
    bodies = {name: body.sample.dtype for name, body in surroundings.bodies.items()}
    roster = Roster([own.name for own in expected],
                    [own.name for own in run.sampled_supplies], bodies,
                    surroundings.has_supply_ports)
    return Participants(
        expected, roster, surroundings.starts(), run.step_ns,
        first_remote=len(run.actuators) if are_here else 0)


def _coordinate(
        node: CoordinatorNode, session: Session, surroundings: Surroundings,
        participants: Participants, report: Report | None, should_stop: StopRequest,
        lost: Callable[[], str | None]) -> None:
    transport = _lockstep(node, session, participants, should_stop, lost)
    try:
        _record(node, session, transport, surroundings, (), report, should_stop)
    finally:
        transport.close()


def _lockstep(
        node: CoordinatorNode, session: Session, participants: Participants,
        should_stop: StopRequest, lost: Callable[[], str | None]) -> LockstepTransport:
    limits = Limits(session.request.join_timeout_s, session.run.tick_timeout_s)
    return LockstepTransport(node, participants, limits, watch=lost, should_stop=should_stop)


def coordinate_locally(
        node: CoordinatorNode, session: Session, report: Report | None,
        should_stop: StopRequest) -> None:
    """Run with the nodes of all actuators in this process; controllers have separate ones."""
    configs = session.run.actuators
    if session.run.controllers:
        refuse_off(', '.join(session.run.controllers))
    surroundings = surroundings_of(session.run)
    participants = _participants(session, surroundings, are_here=True)
    session.freeze_objects()
    group = group_of(session.run)
    timing = timing_of(session.run)
    actuators = []
    for config, actuator in zip(configs, group.actuators):
        namespace, name = parted(placed(session.request.namespace, config.name))
        actuators.append(ActuatorNode(
            _resolver(NodeSetup(config, timing, actuator, session.run.accept)), name,
            has_mailbox=False, namespace=namespace, **_OPTIONS))
    controllers = None
    try:
        look_for_other_coordinator(node)
        transport: Transport
        transport = local = InProcess(group, participants.starts, actuators)
        if session.run.controllers:
            controllers = _lockstep(node, session, participants, should_stop, _none_lost)
            transport = MixedTransport(local, controllers)
        _record(node, session, transport, surroundings, [own.outlet for own in actuators], report,
                should_stop)
    finally:
        if controllers is not None:
            controllers.close()
        for own in actuators:
            own.destroy_node()


def _record(
        node: CoordinatorNode, session: Session, transport: Transport, surroundings: Surroundings,
        actuators: Sequence[Outlet], report: Report | None, should_stop: StopRequest) -> None:
    """Record the run and serve its requests."""
    supplies = node.supplies = SupplyParameters(node, surroundings)
    node.show_fixed(session.run)
    acceptance = Acceptance(node, session.run.accept)
    services = RunServices(
        node, session.pace.factor, lambda coordinator: save_in_bag(session, coordinator),
        supplies, JointCommands(node, session.run, acceptance), acceptance)
    record(session, calling(session.run, transport), surroundings,
           lambda topics: node.outlets(topics, actuators), report, should_stop, services.serve,
           node.get_logger().warning)


def _resolver(setup: NodeSetup) -> Callable[[Node], NodeSetup]:
    return lambda node: setup
