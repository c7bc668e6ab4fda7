"""ROS 2 node of one smart actuator: setpoints in, one tick, messages out."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.constants import participant_digest
from isa_ros.actuator.timing import Timing
from isa_ros.actuator.tunable import changing
from isa_ros.config.runs.acceptance import ACCEPT_ALL
from isa_ros.controller import Setpoint
from isa_ros.core.signals import COMMAND
from isa_ros.errors import one_line, SetpointError, SimulationDiverged
from isa_ros.nodes.actuator.parameters import TunableParameters
from isa_ros.nodes.actuator.setpoint_publishers import IncompatiblePublishers
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.nodes.middleware.publishers import PreparedPublishers
from isa_ros.nodes.middleware.qos import SETPOINT
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.nodes.middleware.servers import open_server
from isa_ros.nodes.middleware.throttled import ThrottledWarnings
from isa_ros.plant.cushion_sheets import is_cushioned
from isa_ros.plant.plant import is_heated
from isa_ros.requests import fill_command
from isa_ros.run.live import every_tick, LivePeriods, PeriodOf
from isa_ros.run.outlets import first_published
from isa_ros.run.packing import Packer
from isa_ros.run.row_messages import Names, topics_of_actuator
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import PublishedRows
from msg_adapters.actuator_messages import APPLIED_PLACE
from msg_adapters.joint_state import TYPE as SETPOINT_TYPE
from msg_adapters.setpoint import msg_to_command
import numpy as np
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger


class NodeSetup(NamedTuple):
    """The actuator that a node simulates, and its timing."""

    config: ConfiguredActuator
    timing: Timing
    actuator: SmartActuator | None = None
    """One of a group of actuators; None: the node makes its own."""
    accept: str = ACCEPT_ALL
    """Of its run."""
    period_of: PeriodOf = every_tick
    """The periods of publishing of its run."""


class ActuatorNode(Node):
    """
    One actuator on ROS topics; the node's name is the actuator's, without its namespace.

    It contains neither physics nor clock: a `ParticipantEnd`, an `InProcess` transport or the
    loop of `run_alone` advances its `actuator`. Setpoints, parameters and requests that
    arrive between two ticks take effect at the next one; a command of the scenario for the same
    tick wins.

    ``resolve`` returns the actuator for the node, whose name and parameters it can read.
    ``has_mailbox``: a `ParticipantEnd` of this node receives its steps.
    """

    def __init__(
            self, resolve: Callable[[Node], NodeSetup], name: str = 'actuator', *,
            has_mailbox: bool, **kwargs: Any) -> None:
        self._tunables: TunableParameters | None = None
        with refusals():
            super().__init__(name, start_parameter_services=False, **kwargs)
        self.setup = resolve(self)
        config, timing, actuator, accept, period_of = self.setup
        self.actuator = actuator or SmartActuator(config, timing)
        """The actuator itself."""
        self._tunables = TunableParameters(
            self, self.actuator, changing(config.sheet, config.load), self._parameter_overrides)
        self._acceptance = Acceptance(self, accept)
        self._acceptance.guard_parameters()
        self._rejected, self._limited = (ThrottledWarnings(self.get_logger()) for _ in range(2))
        memory, plant = self.actuator.memory, config.sheet.plant
        heats_up, has_cushion = is_heated(plant), is_cushioned(plant)
        self._published_ns = 0
        self._packer = Packer(
            Names([(config.name, config.sheet.is_rotary)],
                  heated=[config.name] if heats_up else [],
                  linked=[config.name] if self.actuator.has_link else [],
                  cushioned=[config.name] if has_cushion else []),
            PublishedRows(
                memory.observed, memory.applied, np.zeros(0, SUPPLY_SAMPLE), {}, memory.sent),
            is_run=False, start_ns=timing.start_ns)
        self.outlet = PreparedPublishers(
            self, topics_of_actuator('~', heats_up, self.actuator.has_link, has_cushion))
        """The publishers of the actuator's topics."""
        self._live = LivePeriods(period_of, self._packer.topics_of(0))
        setpoints = self.create_subscription(
            JointState, '~/setpoint', self._on_setpoint, SETPOINT)
        services = [
            self.create_service(SetBool, '~/enable', self._on_enable),
            self.create_service(Trigger, '~/clear_fault', self._on_clear_fault),
            self.create_service(Trigger, '~/quick_stop', self._on_quick_stop)]
        self._setpoints = setpoints
        self._incompatible = IncompatiblePublishers(self, setpoints, SETPOINT_TYPE)
        self._inputs = open_server(
            self, [setpoints], services, self._tunables.services, has_mailbox)

    @property
    def digest(self) -> str:
        """Return a hash of the resolved parameters and of the timing."""
        return participant_digest(self.actuator.digest, self.setup.timing)

    def warm_up(self) -> None:
        """Compile what a tick needs, or load it from the cache, on a copy of the actuator."""
        with suppress(SimulationDiverged):  # so will the actuator, which reports it
            SmartActuator(self.setup.config, self.setup.timing).tick()
        self._packer.pack(0, 0, {})

    def is_watched(self) -> bool:
        """Return whether there is a matched publisher of setpoints, or a subscription."""
        return self.outlet.is_subscribed or self.is_commanded

    def publish(self, n_ticks: int = 1) -> None:
        """
        Publish applied commands, and the state where there is a subscription.

        They are those of the last of so many ticks; the others had nothing to publish.
        """
        if self.has_news(n_ticks):
            self.publish_last()

    def has_news(self, n_ticks: int, keeps: bool = False) -> bool:
        """
        Return whether the last of so many ticks has something to publish.

        There is a subscription, a parameter has changed, the device has a status, or, unless the
        caller ``keeps`` it, a command was applied. Call this once after these ticks.
        """
        if n_ticks > 1:
            self.outlet.skip(n_ticks - 1)
        has_subscribers = self.outlet.has_subscribers()
        t_ns, step_ns = self.actuator.t_ns, self.setup.timing.step_ns
        if max(0, t_ns - n_ticks * step_ns) != self._published_ns:     # a state was restored
            self._packer.rare.announce()
        self._published_ns = t_ns
        return (has_subscribers or bool(self.actuator.applied_parameters)
                or (not keeps and self._packer.has_applied(0))
                or bool(self._packer.rare.devices(t_ns, max(0, t_ns - step_ns))))

    def publish_last(self) -> None:
        """Publish the messages of the last tick that somebody reads, or that are kept."""
        t_ns, tuned = self.actuator.t_ns, self.actuator.applied_parameters
        step_ns = self.setup.timing.step_ns
        self._packer.pack(t_ns, max(0, t_ns - step_ns), {0: tuned} if tuned else {})
        due = self._live.due(t_ns // step_ns, self.outlet.wanted)
        self.outlet.publish(self._packer.of_actuator(0, due))

    def publish_commands(self, commands: Sequence[tuple[int, np.void]]) -> None:
        """
        Publish commands that took effect in earlier ticks, with the end of each tick in ns.

        Without a subscription those that a later one receives are enough.
        """
        applied, step_ns = self.actuator.memory.applied, self.setup.timing.step_ns
        last = applied.copy()
        for t_ns, command in commands[first_published(self.outlet, len(commands)):]:
            applied[0] = command
            self._packer.pack_numbers(t_ns, t_ns - step_ns)
            self.outlet.publish(self._packer.of_actuator(0, (APPLIED_PLACE,)))
        applied[:] = last

    def stamp_from(self, time_ns: int) -> None:
        """Stamp messages from now on as if it were ``time_ns``, on whole ticks."""
        step_ns = self.setup.timing.step_ns
        self._packer.start_ns = time_ns // step_ns * step_ns - self.actuator.t_ns

    def serve(self) -> None:
        """Process the setpoints and requests that have arrived; do not wait."""
        self._inputs.serve()
        self._incompatible.check()

    @property
    def is_commanded(self) -> bool:
        """Return whether a publisher of setpoints is there."""
        handle: Any = self._setpoints.handle     # a third of the time of the subscription's own
        return bool(handle.get_publisher_count())

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; for a gain its current value, set by a service or a setpoint."""
        tuned = None if self._tunables is None else self._tunables.get(name)
        return super().get_parameter(name) if tuned is None else tuned

    def check_publishers(self) -> None:
        """Log publishers whose setpoints cannot be received."""
        self._incompatible.check()

    def _on_setpoint(self, message: JointState) -> None:
        if not self._acceptance.takes_setpoint():
            return
        try:
            command = msg_to_command(message, self.setup.config.name)
            limited = self.actuator.admit(command)
        except SetpointError as error:
            self._rejected(f'setpoint rejected: {one_line(str(error))}')
            return
        if limited:
            self._limited(limited)

    def _on_enable(
            self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data:
            self._request(response, 'enabled', Setpoint(is_enabled=True))
        else:
            self._request(response, 'disabled', Setpoint(is_enabled=False))
        return response

    def _on_clear_fault(
            self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._request(response, 'fault cleared', Setpoint(clear_fault=True))
        return response

    def _on_quick_stop(
            self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._request(response, 'quick stop', Setpoint(quick_stop=True))
        return response

    def _request(self, response: Any, what: str, request: Setpoint) -> None:
        """Accept a request where the state of the device has a transition for it."""
        if not self._acceptance.is_open:
            response.success, response.message = False, self._acceptance.reason
            return
        command = np.zeros(1, COMMAND)[0]
        fill_command(self.setup.config.name, request, command)
        response.success, response.message = self.actuator.request(command, what)
