"""All values of an actuator that may change as parameters of its node, with their services."""

from collections.abc import Mapping, Sequence

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.changeable import Changeable
from isa_ros.core.device import MODES
from isa_ros.core.units import after, of_coordinate
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.parameter_services import open_parameter_services
from isa_ros.nodes.middleware.parameters import accept_integers, declare, refuse_unknown
from isa_ros.reu.wiring import mode_of, possible_modes
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service


MODE = 'mode'
"""Name of the parameter of the device's mode."""


class TunableParameters:
    """
    Declares what is ``changing`` and the mode on ``node``, and passes new values to ``actuator``.

    Names and units are those of `isa params`; the unit is part of the description. A gain also has
    its name of messages, in SI, as it was declared before: ``force.kp`` for ``reu.force.kp``.

    The value of a parameter is read from the actuator, also if a setpoint has changed it.
    ``overrides`` are those of the command line, in force from the first tick.

    Raises
    ------
    ConfigError
        An override is of no parameter of the node, or its value is refused.

    """

    def __init__(
            self, node: Node, actuator: SmartActuator,
            changing: Mapping[str, Changeable],
            overrides: Mapping[str, Parameter]) -> None:
        self._actuator = actuator
        declared = {one.name: one for own in changing.values() for one in (own.keyed, own)}
        self._names = frozenset(declared)
        for name, own in declared.items():
            node.declare_parameter(
                name, own.shown(own.value), descriptor(own, actuator.sheet.is_rotary),
                ignore_override=True)
        mode = self._declare_mode(node)
        refuse_unknown(node)
        if mode is not None:
            actuator.change_mode(mode)
        actuator.tune({name: overrides[name].value for name in declared if name in overrides})
        accept_integers(node)
        node.add_on_set_parameters_callback(self._on_set)
        self.services: Sequence[Service] = open_parameter_services(node)

    def _declare_mode(self, node: Node) -> str | None:
        """Declare the mode and return the one of the command line, or None."""
        reu = self._actuator.sheet.reu
        names = ', '.join(MODES[mode] for mode in possible_modes(reu))
        own = declare(node, MODE, MODES[self._actuator.mode], ParameterDescriptor(
            description='outermost control block that acts; changed without a jump of the valve '
            'current', additional_constraints=f'one of {names}'))
        mode_of(own, reu, f'{node.get_name()}: parameter {MODE}')
        return own if MODE in node._parameter_overrides else None

    def get(self, name: str) -> Parameter | None:
        """Return a value or the mode as it will be at the next tick; None: neither."""
        if name == MODE:
            return Parameter(name, value=MODES[self._actuator.mode])
        if name not in self._names:
            return None
        return Parameter(name, value=self._actuator.parameter(name))

    def _on_set(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        modes = [p.value for p in parameters if p.name == MODE]
        try:
            for mode in modes:
                mode_of(mode, self._actuator.sheet.reu)
            self._actuator.tune(
                {p.name: p.value for p in parameters if p.name in self._names})
        except ConfigError as error:
            return SetParametersResult(successful=False, reason=str(error))
        for mode in modes:
            self._actuator.change_mode(mode)
        return SetParametersResult(successful=True)


def descriptor(own: Changeable, is_rotary: bool = False) -> ParameterDescriptor:
    """
    Return unit, meaning and range of a value; excluded bounds are listed as constraints.

    The unit is that of a linear or of a rotary actuator. A choice has its words.
    """
    if own.words:
        return ParameterDescriptor(
            description=own.doc, additional_constraints=f'one of {", ".join(own.choices)}')
    bounds = own.bounds
    relations = {'gt': '>', 'lt': '<'}
    excluded = [f'{sign} {bounds[name]:g}' for name, sign in relations.items() if name in bounds]
    return ParameterDescriptor(
        description=own.doc + after(', ', of_coordinate(own.unit, is_rotary)),
        additional_constraints=', '.join(excluded),
        floating_point_range=[FloatingPointRange(
            from_value=bounds.get('ge', bounds.get('gt', 0.0)),
            to_value=bounds.get('le', bounds.get('lt', 0.0)))])
