"""What a node accepts from topics, services and parameters: the key `accept` of a run."""

from collections.abc import Collection, Sequence

from isa_ros.config.runs.acceptance import ACCEPT_ALL
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.throttled import ThrottledWarnings
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

ACCEPT = 'accept'


class Acceptance:
    """
    Refuses commands of others to a node where its run accepts those of its scenario only.

    The parameter `ACCEPT` shows it. ``accept`` is the value of the key.
    """

    def __init__(self, node: Node, accept: str) -> None:
        self._node, self._warn = node, ThrottledWarnings(node.get_logger())
        self.is_open = accept == ACCEPT_ALL
        self.reason = f'the run has {ACCEPT}: {accept}'
        node.declare_parameter(ACCEPT, accept, ParameterDescriptor(
            read_only=True, description='who commands the run: all, also topics, services and '
            'parameters; or scenario, with controllers and the master of a bus'),
            ignore_override=True)

    def takes_setpoint(self) -> bool:
        """Return whether a setpoint of a topic is taken; warn of one that is not."""
        if not self.is_open:
            self._warn(f'setpoint rejected: {self.reason}')
        return self.is_open

    def refuse_closed(self) -> None:
        """Raise `ConfigError` with the reason where only the scenario commands."""
        if not self.is_open:
            raise ConfigError(self.reason)

    def guard_parameters(self, free: Collection[str] = ()) -> None:
        """
        Refuse from now on to set parameters, but those that change no signal: ``free``.

        Of several callbacks rclpy calls the last one first, so that this is the last to be added.
        """
        if not self.is_open:
            self._node.add_on_set_parameters_callback(
                lambda parameters: self._set(parameters, free))

    def _set(self, parameters: Sequence[Parameter], free: Collection[str]) -> SetParametersResult:
        if all(parameter.name in free for parameter in parameters):
            return SetParametersResult(successful=True)
        return SetParametersResult(successful=False, reason=self.reason)
