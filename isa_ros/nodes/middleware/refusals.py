"""Errors of the middleware as one-line errors of isa_ros."""

from collections.abc import Iterator
from contextlib import contextmanager
import os

from isa_ros.errors import ConfigError
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

_SECURITY = 'ROS_SECURITY_ENABLE'
_OF_ARGUMENTS = (_rclpy.RCLInvalidROSArgsError, _rclpy.UnknownROSArgsError)


@contextmanager
def refusals() -> Iterator[None]:
    """
    Convert errors of the middleware, when it starts or creates a node, to `ConfigError`.

    Errors of command-line arguments are not converted.

    Raises
    ------
    ConfigError
        The environment cannot be used, for example because the middleware was built without
        security or the security files are missing; or a parameter of rclpy has a wrong type.

    """
    try:
        yield
    except _OF_ARGUMENTS:
        raise
    except InvalidParameterTypeException as error:  # of a parameter of rclpy itself
        raise ConfigError(f'middleware: {error}') from error
    except _rclpy.RCLError as error:
        reason = str(error).splitlines()[0]
        hint = ''
        if os.environ.get(_SECURITY) == 'true':
            hint = (f'; {_SECURITY} = true requires security, which this middleware lacks or '
                    'has no files for, see docs/network.md')
        raise ConfigError(f'middleware: {reason}{hint}') from error
