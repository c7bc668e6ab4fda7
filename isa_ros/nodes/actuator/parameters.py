"""The tunable values of an actuator as parameters of its node, with the standard services."""

from collections.abc import Mapping, Sequence

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.tunable import Tunable
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.parameters import accept_integers, refuse_unknown
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService
from rclpy.service import Service


class TunableParameters:
    """
    Declares ``tunables`` on ``node`` and passes new values to ``actuator``, SI.

    The value of a parameter is read from the actuator, also if a setpoint has changed it.
    ``overrides`` are those of the command line, in force from the first tick.

    Raises
    ------
    ConfigError
        An override is of no parameter of the node, or its value is refused.

    """

    def __init__(
            self, node: Node, actuator: SmartActuator, tunables: Mapping[str, Tunable],
            overrides: Mapping[str, Parameter]) -> None:
        self._actuator = actuator
        self._names = frozenset(tunables)
        for tunable in tunables.values():
            node.declare_parameter(
                tunable.name, tunable.value, descriptor(tunable), ignore_override=True)
        refuse_unknown(node)
        actuator.tune({name: overrides[name].value for name in tunables if name in overrides})
        accept_integers(node)
        node.add_on_set_parameters_callback(self._on_set)
        others = set(node.services)
        ParameterService(node)
        self.services: Sequence[Service] = [s for s in node.services if s not in others]

    def get(self, name: str) -> Parameter | None:
        """Return a tunable as it will be at the next tick; None: not a tunable."""
        if name not in self._names:
            return None
        return Parameter(name, value=self._actuator.parameter(name))

    def _on_set(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        try:
            self._actuator.tune(
                {p.name: p.value for p in parameters if p.name in self._names})
        except ConfigError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)


def descriptor(tunable: Tunable) -> ParameterDescriptor:
    """Return unit, meaning and range of a tunable; excluded bounds are listed as constraints."""
    bounds = tunable.bounds
    relations = {'gt': '>', 'lt': '<'}
    excluded = [f'{sign} {bounds[name]:g}' for name, sign in relations.items() if name in bounds]
    return ParameterDescriptor(
        description=f'{tunable.doc}, {tunable.unit}',
        additional_constraints=', '.join(excluded),
        floating_point_range=[FloatingPointRange(
            from_value=bounds.get('ge', bounds.get('gt', 0.0)),
            to_value=bounds.get('le', bounds.get('lt', 0.0)))])
