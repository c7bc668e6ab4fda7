"""Read and set ROS parameters of a node: gains and limits of an actuator."""

from collections.abc import Callable, Collection, Sequence
from typing import Any, NamedTuple

from isa_ros.actuator.tunable import changing
from isa_ros.config.models.catalogue import model_names
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.core.frozen import fields_of
from isa_ros.core.parameter import Parameters
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, one_line
from isa_ros.nodes.terminal.visitor import absolute, visiting, Visitor
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import (
    DescribeParameters, GetParameters, ListParameters, SetParametersAtomically)
from rclpy.parameter import Parameter, parameter_value_to_python
import yaml


class ParameterChange(NamedTuple):
    """A parameter to set, or to read without a text."""

    name: str
    text: str | None


def change_of(text: str) -> ParameterChange:
    """
    Return what KEY=VALUE or KEY asks for.

    Raises
    ------
    ConfigError
        There is no key.

    """
    name, sign, value = text.partition('=')
    if not name.strip():
        raise ConfigError(f'{text!r}: must be KEY=VALUE, or KEY to read it')
    return ParameterChange(name, value if sign else None)


def set_parameters(node: str, changes: Sequence[ParameterChange], timeout_s: float,
                   print_line: Callable[[str], None]) -> None:
    """
    Set all changes with a value at once, and print each parameter with its values.

    Raises
    ------
    ConfigError
        The node has no such parameter, or refuses a value; then none is set.
    RunError
        The node did not appear, or did not answer, within the timeout.

    """
    path = absolute(node)
    with visiting(timeout_s) as visitor:
        before = _values(visitor, path, changes)
        wanted = [_parameter(change) for change in changes if change.text is not None]
        if wanted:
            result = _asked(visitor, path, 'set_parameters_atomically', SetParametersAtomically,
                            SetParametersAtomically.Request(
                                parameters=[each.to_parameter_msg() for each in wanted])).result
            if not result.successful:
                reason = _beyond(visitor, path, wanted) or result.reason
                raise ConfigError(f'{path}: {one_line(reason)}')
        after = _values(visitor, path, changes) if wanted else before
    for change, old, new in zip(changes, before, after, strict=True):
        print_line(f'{change.name}: {new}' if change.text is None
                   else f'{change.name}: {old} -> {new}')


def _parameter(change: ParameterChange) -> Parameter:
    try:
        value = yaml.safe_load(change.text or "''")
        return Parameter(change.name, value=_number(value))
    except (yaml.YAMLError, TypeError, AttributeError):
        raise ConfigError(f'{change.name} = {change.text}: not a value of a parameter') from None


def _number(value: Any) -> Any:
    """Return a value of YAML, where 2e-5 without a point is a text, as Python reads it."""
    if not isinstance(value, str):
        return value
    try:
        return float(value)
    except ValueError:
        return value


def _beyond(visitor: Visitor, path: str, wanted: Sequence[Parameter]) -> str:
    """Return which value was refused for its type or range, with its meaning; '': for neither."""
    described = _asked(visitor, path, 'describe_parameters', DescribeParameters,
                       DescribeParameters.Request(names=[own.name for own in wanted])).descriptors
    for own, known in zip(wanted, described):
        needed = needed_of(own.value, known)
        if needed:
            return f'{own.name} = {own.value if own.value != "" else "nothing"}, must be {needed}'
    return ''


def needed_of(value: Any, known: ParameterDescriptor) -> str:
    """Return what a value must be by the descriptor of its parameter; '' if it is."""
    meaning = f': {known.description}' if known.description else ''
    if known.type not in (Parameter.Type.DOUBLE.value, Parameter.Type.INTEGER.value):
        return ''
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return f'a number{meaning}'
    for bounds in (*known.floating_point_range, *known.integer_range):
        if not bounds.from_value <= value <= bounds.to_value:
            return f'{bounds.from_value:g} to {bounds.to_value:g}{meaning}'
    return ''


def _values(visitor: Visitor, path: str, changes: Sequence[ParameterChange]) -> list[Any]:
    names = [change.name for change in changes]
    found = _asked(visitor, path, 'get_parameters', GetParameters,
                   GetParameters.Request(names=names)).values
    if len(found) != len(names):    # rclpy leaves all out if one is unknown
        known = _asked(visitor, path, 'list_parameters', ListParameters,
                       ListParameters.Request()).result.names
        for name in names:
            if name not in known:
                raise ConfigError(f'{path}: parameter {name} ' + (
                    'does not change during a run; where the model has it, it is a key of the run '
                    'file, and of --set'
                    if _is_key(name, known) else f'is unknown; {alternatives(name, known)}'))
    return [parameter_value_to_python(value) for value in found]


def _is_key(name: str, known: Collection[str]) -> bool:
    """Return whether a model has such a parameter, which none changes; ``known`` a node's own."""
    sheets = [default_actuator(model, model).sheet for model in model_names()]
    may_change = {each.key for own in sheets for each in changing(own).values()}
    return name not in may_change and not may_change.isdisjoint(known) and any(
        _has(own, name.split('.')) for own in sheets)


def _has(own: object, path: Sequence[str]) -> bool:
    """Return whether a set of parameters has a value by these names, one within the other."""
    first, *rest = path
    if not isinstance(own, Parameters) or first not in [f.name for f in fields_of(type(own))]:
        return False
    value = getattr(own, first)
    return _has(value, rest) if rest else not isinstance(value, Parameters)


def _asked(visitor: Visitor, path: str, service: str, kind: Any, request: Any) -> Any:
    """Return the answer of a node's service."""
    return visitor.ask('node', path, service, kind, request, _nodes)


def _nodes(visitor: Visitor) -> list[str]:
    return [f'{place.rstrip("/")}/{name}'
            for name, place in visitor.node.get_node_names_and_namespaces()
            if name != visitor.node.get_name()]
