"""The values of the supplies that may change as parameters of the coordinator's node."""

from collections.abc import Sequence

from isa_ros.errors import ConfigError
from isa_ros.nodes.actuator.parameters import descriptor
from isa_ros.surroundings.surroundings import Surroundings
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter


class SupplyParameters:
    """
    Declares what may change of the supplies on ``node``, named SUPPLY.KEY as in `isa params`.

    The value of a parameter is read from the surroundings, also if a fault has changed it.
    """

    def __init__(self, node: Node, surroundings: Surroundings) -> None:
        self._surroundings = surroundings
        for own in surroundings.changing.values():
            node.declare_parameter(own.name, own.value, descriptor(own), ignore_override=True)

    def get(self, name: str) -> Parameter | None:
        """Return a value as it will be at the next tick; None: not one of the supplies."""
        if name not in self._surroundings.changing:
            return None
        return Parameter(name, value=self._surroundings.tuned_value(name))

    def on_set(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Pass new values to the supplies; they take effect at the next tick."""
        known = self._surroundings.changing
        try:
            self._surroundings.tune({p.name: p.value for p in parameters if p.name in known})
        except ConfigError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)
