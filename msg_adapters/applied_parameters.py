"""rcl_interfaces/ParameterEvent: tuned values, with the tick from which they are in force."""

from collections.abc import Mapping

from builtin_interfaces.msg import Time
from isa_ros.errors import SetpointError
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.template import stamp
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterType, ParameterValue

TYPE = 'rcl_interfaces/msg/ParameterEvent'


def applied_parameters(name: str, values: Mapping[str, float], t_ns: int) -> bytes:
    """Return the CDR bytes of changed values of actuator ``name``, SI, in force from ``t_ns``."""
    seconds, nanoseconds = stamp(t_ns)
    return encode(ParameterEvent(
        stamp=Time(sec=seconds, nanosec=nanoseconds), node=f'/{name}',
        changed_parameters=[
            Parameter(name=key, value=ParameterValue(
                type=ParameterType.PARAMETER_DOUBLE, double_value=value))
            for key, value in values.items()]))


def tuned_values(data: bytes, name: str) -> dict[str, float]:
    """
    Return the values of recorded applied parameters; inverse of `applied_parameters`.

    Raises
    ------
    SetpointError
        the event is of another actuator, has new or deleted parameters or a name twice, or a
        value is not a number.
    CdrError
        the bytes are not a ParameterEvent.

    """
    event = decode(data, ParameterEvent)
    if event.node != f'/{name}' or event.new_parameters or event.deleted_parameters:
        raise SetpointError(
            f"{name}: applied parameters of node {event.node!r}, must be changes of '/{name}'")
    values: dict[str, float] = {}
    for parameter in event.changed_parameters:
        if parameter.name in values:
            raise SetpointError(f'{name}: applied parameters name {parameter.name} twice')
        if parameter.value.type != ParameterType.PARAMETER_DOUBLE:
            raise SetpointError(
                f'{name}: {parameter.name} is of type {parameter.value.type}, must be '
                f'{ParameterType.PARAMETER_DOUBLE} (double)')
        values[parameter.name] = parameter.value.double_value
    return values
