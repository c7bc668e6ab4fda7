"""Setpoints in joint space, on one topic for each body: ``joint_command``."""

from collections.abc import Mapping
import math

from isa_ros.actuator.setpoint_range import complete, SetpointRange
from isa_ros.config.runs.body_config import BodyConfig, JOINT_COMMAND
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.signals import GAINS_OF_COMMAND, HAS_SETPOINT
from isa_ros.errors import one_line, SetpointError
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.nodes.middleware.qos import SETPOINT
from isa_ros.nodes.middleware.throttled import ThrottledWarnings
from isa_ros.run.coordinator import Coordinator
from isa_ros.surroundings.joint_space import to_actuator
from isa_ros.tick.exchange import Rows
from msg_adapters.setpoint import msg_to_commands
import numpy as np
from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState


class JointCommands:
    """
    Receives the setpoints for the joints of the bodies of a run, as messages on ``node``.

    A message has any of the joints of its body; it is taken as a whole or refused as a whole, with
    a warning; a joint whose numbers are all NaN is not named by it, as hardware interfaces of
    ros2_control send one that no controller has claimed. It takes effect at the next tick, where
    neither the scenario nor a controller commands the same actuator.
    """

    def __init__(self, node: Node, run: RunConfig, acceptance: Acceptance) -> None:
        self._acceptance = acceptance
        self._warn = ThrottledWarnings(node.get_logger())
        self._run = run
        self._ranges = [SetpointRange(own.name, own.sheet, own.beyond_range)
                        for own in run.actuators]
        self._coordinator: Coordinator | None = None
        self._tick = 0
        self._commanded: set[int] = set()  # rows before this tick, by an earlier message
        self.subscriptions = [
            self._subscribed(node, body) for body in run.bodies if body.joint_space]

    def _subscribed(self, node: Node, body: BodyConfig) -> Subscription:
        return node.create_subscription(
            JointState, f'{body.prefix}{JOINT_COMMAND}',
            lambda message: self._on_message(message, body), SETPOINT)

    def bind(self, coordinator: Coordinator) -> None:
        """Command the run of a coordinator from now on."""
        self._coordinator = coordinator

    def _on_message(self, message: JointState, body: BodyConfig) -> None:
        assert self._coordinator is not None, 'messages are taken during a run'
        if not self._acceptance.takes_setpoint():
            return
        rows = self._coordinator.rows
        try:
            commands, limited = self.commands(message, body, rows)
        except SetpointError as error:
            self._warn(f'setpoint rejected: {one_line(str(error))}')
            return
        if limited:
            self._warn(limited)
        if self._coordinator.ticks != self._tick:
            self._tick, self._commanded = self._coordinator.ticks, set()
        for row, command in commands.items():
            if row in self._commanded:
                _keep_gains(command, rows.requests[row])
            elif rows.requests['kinds'][row]:
                continue
            self._commanded.add(row)
            rows.requests[row] = command

    def commands(
            self, message: JointState, body: BodyConfig, rows: Rows
            ) -> tuple[Mapping[int, np.void], str]:
        """
        Return the `COMMAND` of each row that a message moves, and what was limited, or ''.

        Raises
        ------
        SetpointError
            The message is not a setpoint of joints of the body, a value is beyond its range, or
            all are NaN.

        """
        found, limited = {}, []
        for name, command in msg_to_commands(message, list(body.joint_space)).items():
            if _is_empty(message, name, command):
                continue
            joint = body.joint_space[name]
            row = self._run.index(joint.actuator)
            sample = rows.samples[row]
            to_actuator(name, joint, rows.bodies[body.name][0], command)
            limited.append(self._ranges[row].admit(command, int(sample['device_mode'])))
            complete(command, float(sample['position']))
            found[row] = command
        if not found:
            raise SetpointError('setpoint gives no joint a number, all are NaN')
        return found, '; '.join(filter(None, limited))


def _keep_gains(command: np.void, pending: np.void) -> None:
    """Give a command the gains of one that it replaces, where it has none."""
    for gain in GAINS_OF_COMMAND:
        if math.isnan(command[gain]):
            command[gain] = pending[gain]


def _is_empty(message: JointState, name: str, command: np.void) -> bool:
    """Return whether a joint has an entry of its own, with nothing but NaN, and no gain."""
    if command['kinds'] != HAS_SETPOINT or not all(
            math.isnan(command[gain]) for gain in GAINS_OF_COMMAND):
        return False
    place = message.name.index(name)
    return all(math.isnan(values[place]) for values in (
        message.position, message.velocity, message.effort) if len(values) > place)
