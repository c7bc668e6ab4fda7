"""The command line of an executable: ROS arguments only."""

from collections.abc import Sequence
import os
import sys

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.processes.ending import DEBUG_VARIABLE
import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

_HELP = ('-h', '--help')
_DEBUG = '--debug'


def init_ros(args: Sequence[str] | None, usage: str) -> None:
    """
    Initialise rclpy from the command line; ``--help`` prints ``usage`` and exits with 0.

    With ``--debug`` an error is shown with its traceback.

    Raises
    ------
    ConfigError
        An argument is not a ROS argument or is malformed, or the middleware cannot be initialised.

    """
    given = list(sys.argv if args is None else args)
    try:
        rest = remove_ros_args(given)[1:]
        if any(argument in _HELP for argument in rest):
            print(usage)
            raise SystemExit(0)
        if _DEBUG in rest:
            os.environ[DEBUG_VARIABLE] = '1'
            rest.remove(_DEBUG)
        if rest:
            raise ConfigError(f'argument {rest[0]!r} is unknown; {usage}')
        with refusals():
            rclpy.init(args=given, signal_handler_options=SignalHandlerOptions.NO)
    except (_rclpy.RCLInvalidROSArgsError, _rclpy.UnknownROSArgsError) as error:
        raise ConfigError(f'{str(error).splitlines()[0]}; {usage}') from error
