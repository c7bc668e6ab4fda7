"""The standard services of parameters, without rclpy's exceptions for malformed requests."""

from collections.abc import Callable, Sequence
from typing import Any

from isa_ros.errors import one_line
from isa_ros.nodes.middleware.parameters import unknown
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter_service import ParameterService
from rclpy.service import Service

_MALFORMED = (ParameterException, ValueError, TypeError)
"""Raised by rclpy for names and values that no parameter has, as a value of type 99."""


def open_parameter_services(node: Node) -> Sequence[Service]:
    """Create the parameter services of a node, and return them."""
    others = set(node.services)
    ParameterService(node)
    own = [service for service in node.services if service not in others]
    for service in own:
        service.callback = checked(node, service.srv_type, service.callback)
    return own


def checked(
        node: Node, service_type: Any, callback: Callable[..., Any]) -> Callable[..., Any]:
    """Return a callback that answers a malformed request with its reason, or with nothing."""
    if service_type is SetParameters:
        return _one_by_one(node, callback)
    if service_type is SetParametersAtomically:
        return _together(node, callback)

    def answer(request: Any, response: Any) -> Any:
        try:
            return callback(request, response)
        except _MALFORMED:
            return service_type.Response()
    return answer


def _refuse_undeclared(node: Node, request: Any) -> None:
    """Raise the sentence for a name that the node does not have: rclpy's is without a name."""
    for parameter in request.parameters:
        if not node.has_parameter(parameter.name):
            raise ValueError(unknown(node, parameter.name))


def _one_by_one(node: Node, callback: Callable[..., Any]) -> Callable[..., Any]:
    """Set each parameter on its own: one that is malformed must not hide the result of others."""
    def answer(request: Any, response: Any) -> Any:
        for parameter in request.parameters:
            one = SetParameters.Request(parameters=[parameter])
            try:
                _refuse_undeclared(node, one)
                results = callback(one, SetParameters.Response()).results
            except _MALFORMED as error:
                results = [_refused(error)]
            response.results.extend(results)
        return response
    return answer


def _together(node: Node, callback: Callable[..., Any]) -> Callable[..., Any]:
    def answer(request: Any, response: Any) -> Any:
        try:
            _refuse_undeclared(node, request)
            return callback(request, response)
        except _MALFORMED as error:
            response.result = _refused(error)
            return response
    return answer


def _refused(error: Exception) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=one_line(str(error)))
