"""What the middleware refuses, in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
import os

from isa_ros.errors import ConfigError
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

_SECURITY = 'ROS_SECURITY_ENABLE'
_OF_ARGUMENTS = (_rclpy.RCLInvalidROSArgsError, _rclpy.UnknownROSArgsError)


@contextmanager
def refusals() -> Iterator[None]:
    """
    Say in one line why the middleware does not start, or makes no node.

    Errors of command-line arguments pass as they are.

    Raises
    ------
    ConfigError
        It cannot do what the environment asks for: security that it was built without or
        whose files are missing, for one.

    """
    try:
        yield
    except _OF_ARGUMENTS:
        raise
    except _rclpy.RCLError as error:
        reason = str(error).splitlines()[0]
        hint = ''
        if os.environ.get(_SECURITY) == 'true':
            hint = (f'; {_SECURITY} = true asks for security, which this middleware lacks or '
                    'finds no files for, see docs/network.md')
        raise ConfigError(f'middleware: {reason}{hint}') from error
