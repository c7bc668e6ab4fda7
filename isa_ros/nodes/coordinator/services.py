"""Services of the coordinator, served between two ticks: pause, step, reset and save."""

from collections.abc import Callable
from typing import Any

from isa_ros.errors import IsaError
from isa_ros.nodes.coordinator.attempts import attempted, LARGEST_STEP
from isa_ros.nodes.coordinator.joint_commands import JointCommands
from isa_ros.nodes.coordinator.parameters import SupplyParameters
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.nodes.middleware.handles import has_handles
from isa_ros.nodes.middleware.parameter_services import open_parameter_services
from isa_ros.nodes.middleware.parameters import accept_integers, declare
from isa_ros.nodes.middleware.qos import KEPT
from isa_ros.nodes.middleware.servers import DirectServer
from isa_ros.run.coordinator import Coordinator
from msg_adapters.optional import is_installed, SIMULATION
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, Trigger

STEP_COUNT = 'step_count'
REAL_TIME_FACTOR = 'real_time_factor'

Save = Callable[[Coordinator], str]
"""Saves the state of a run and returns the path."""


class RunServices:
    """
    Services and parameters that change a run between two ticks, and the topic ``~/paused``.

    A step is answered when its ticks are finished, other requests at once. This needs the
    handles of `DirectServer`, as an executor would run callbacks during a tick. Without them the
    services are missing and a warning is logged.
    """

    def __init__(
            self, node: Node, real_time_factor: float, save: Save,
            supplies: SupplyParameters | None = None,
            joints: JointCommands | None = None, acceptance: Acceptance | None = None) -> None:
        self._node = node
        self._save = save
        self._supplies, self._joints, self._acceptance = supplies, joints, acceptance
        self._coordinator: Coordinator | None = None
        self._server: DirectServer | None = None
        self._is_paused: bool | None = None  # as it was published last
        self._paused = node.create_publisher(Bool, '~/paused', KEPT)
        if not has_handles():
            node.get_logger().warning(
                'pause, step, reset and save are not available with this version of rclpy')
            return
        declare(node, STEP_COUNT, 1, ParameterDescriptor(
            description='ticks of one call of ~/step',
            integer_range=[IntegerRange(from_value=1, to_value=LARGEST_STEP, step=1)]))
        if not node.has_parameter(REAL_TIME_FACTOR):
            declare(node, REAL_TIME_FACTOR, real_time_factor, ParameterDescriptor(
                description='largest real-time factor; 0: as fast as possible'))
        accept_integers(node)
        node.add_on_set_parameters_callback(self._on_parameters)
        if acceptance is not None:
            acceptance.guard_parameters((STEP_COUNT, REAL_TIME_FACTOR))
        own = [
            node.create_service(SetBool, '~/pause', self._on_pause),
            node.create_service(Trigger, '~/step', self._on_step),
            node.create_service(Trigger, '~/reset', self._on_reset),
            node.create_service(Trigger, '~/save', self._on_save),
            node.create_service(SetBool, 'emergency_stop', self._on_emergency_stop),
            *self._standard_services()]
        parameters = open_parameter_services(node)
        self._server = DirectServer(
            node.get_logger(), [] if joints is None else joints.subscriptions, own, parameters,
            lambda: self._run.is_reset)

    def _standard_services(self) -> list[Service]:
        """Create those of simulation_interfaces, if it is installed."""
        if not is_installed(SIMULATION):
            return []
        from isa_ros.nodes.coordinator.simulation_services import SimulationServices
        return SimulationServices(self._node, lambda: self._run, self._acceptance).services

    def serve(self, coordinator: Coordinator) -> None:
        """Answer all requests since the last call."""
        if self._server is not None:
            self._coordinator = coordinator
            if self._joints is not None:
                self._joints.bind(coordinator)
            self._server.serve()
        if coordinator.is_paused != self._is_paused:
            self._is_paused = coordinator.is_paused
            self._paused.publish(Bool(data=coordinator.is_paused))

    @property
    def _run(self) -> Coordinator:
        assert self._coordinator is not None, 'serve has set the coordinator'
        return self._coordinator

    def _on_pause(self, request: SetBool.Request, response: SetBool.Response) -> Any:
        return self._answer(response, lambda: self._pause(request.data))

    def _on_emergency_stop(self, request: SetBool.Request, response: SetBool.Response) -> Any:
        return self._answer(response, lambda: self._emergency_stop(request.data))

    def _on_step(self, request: Trigger.Request, response: Trigger.Response) -> Any:
        return self._answer(response, self._step)

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Any:
        return self._answer(response, self._reset)

    def _on_save(self, request: Trigger.Request, response: Trigger.Response) -> Any:
        return self._answer(response, lambda: f'saved to {self._save(self._run)}')

    def _answer(self, response: Any, work: Callable[[], str]) -> Any:
        response.success, response.message = attempted(work)
        return response

    def _pause(self, is_paused: bool) -> str:
        self._run.pause(is_paused)
        return f'{"paused" if is_paused else "running"} from {self._instant()}'

    def _emergency_stop(self, is_open: bool) -> str:
        self._run.emergency_stop(is_open)
        return f'emergency stop {"from" if is_open else "released at"} {self._instant()}'

    def _step(self) -> str:
        count = self._node.get_parameter(STEP_COUNT).value
        before = self._run.ticks
        self._run.step(count)
        return f'{self._run.ticks - before} ticks to {self._instant()}'

    def _reset(self) -> str:
        if self._acceptance is not None:
            self._acceptance.refuse_closed()
        instant = self._instant()
        self._run.reset()
        return f'reset at {instant}, starts again at t = 0'

    def _instant(self) -> str:
        return f't = {self._run.t_ns * 1e-9:.6f} s'

    def _on_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == REAL_TIME_FACTOR:
                try:
                    self._run.set_real_time_factor(parameter.value)
                except IsaError as error:
                    return SetParametersResult(successful=False, reason=str(error))
        if self._supplies is not None:
            return self._supplies.on_set(parameters)
        return SetParametersResult(successful=True)
