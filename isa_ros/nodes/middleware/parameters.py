"""Parameters of a node: overrides of the wrong type, or with a wrong name, in one line."""

from collections.abc import Sequence
from typing import Any

from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.exceptions import InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

_TYPE = Parameter.Type
_EXPECTED = {
    _TYPE.BOOL: 'true or false', _TYPE.INTEGER: 'an integer', _TYPE.DOUBLE: 'a number',
    _TYPE.STRING: 'a text', _TYPE.STRING_ARRAY: "a list of names, as ['a', 'b']"}
_OF_RCLPY = ('use_sim_time', 'start_type_description_service')
_OF_PUBLISHERS = 'qos_overrides.'


def declare(node: Node, name: str, default: Any, descriptor: ParameterDescriptor) -> Any:
    """
    Declare a parameter and return its value; an integer is accepted for a double.

    ``default``: a value, or the type of a list that is empty by default. It is set to the empty
    list: rclpy answers a request for several values with none if one of them has no value.

    Raises
    ------
    ConfigError
        The override has another type, or is out of the descriptor's range.

    """
    type_ = default if isinstance(default, _TYPE) else _TYPE.from_parameter_value(default)
    override = node._parameter_overrides.get(name)
    if override is not None:
        given = node._parameter_overrides[name] = as_declared(override, type_)
        if given.type_ is not type_:
            raise ConfigError(
                f'{node.get_name()}: parameter {name} = {given.value!r}, must be '
                f'{_EXPECTED[type_]} ({descriptor.description})')
    try:
        declared = node.declare_parameter(name, default, descriptor)
        if declared.type_ is _TYPE.NOT_SET:
            declared = node._parameters[name] = Parameter(name, type_, [])
        return declared.value
    except InvalidParameterValueException as error:
        raise ConfigError(f'{node.get_name()}: parameter {name}: {error}') from error


def as_declared(parameter: Parameter, type_: Parameter.Type) -> Parameter:
    """Return a parameter, converted if it is an integer and declared as a double."""
    if parameter.type_ is _TYPE.INTEGER and type_ is _TYPE.DOUBLE:
        return Parameter(parameter.name, value=float(parameter.value))
    return parameter


def accept_integers(node: Node) -> None:
    """Convert integers that are set later for parameters declared as doubles."""
    def convert(parameters: list[Parameter]) -> list[Parameter]:
        return [as_declared(parameter, _TYPE(node.describe_parameter(parameter.name).type))
                if node.has_parameter(parameter.name) else parameter for parameter in parameters]
    node.add_pre_set_parameters_callback(convert)


def refuse_unknown(node: Node, more: Sequence[str] = ()) -> None:
    """
    Refuse overrides of parameters that the node does not have.

    ``more`` are those it declares later.

    Raises
    ------
    ConfigError
        An override is unknown; the message has the names close to it.

    """
    for name in node._parameter_overrides:
        if (node.has_parameter(name) or name in (*more, *_OF_RCLPY)
                or name.startswith(_OF_PUBLISHERS)):
            continue
        raise ConfigError(unknown(node, name, more))


def unknown(node: Node, name: str, more: Sequence[str] = ()) -> str:
    """Return that a parameter is unknown, and the names of the node, and ``more``, close to it."""
    own = [known for known in node.get_parameters_by_prefix('') if known not in _OF_RCLPY]
    return (f'{node.get_name()}: parameter {name} is unknown; '
            f'{alternatives(name, [*own, *more])}')
