"""
Middleware settings for the lockstep, used unless the user has set others.

They must be set before `rclpy.init`; child processes inherit them.
"""

from collections.abc import Iterator, Mapping, MutableMapping
from contextlib import contextmanager
import os
from pathlib import Path
import tempfile

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.discovery import refuse_invalid
from rclpy.utilities import get_rmw_implementation_identifier

LOCALHOST_PROFILE = Path(__file__).with_name('fastdds_localhost.xml')
NETWORK_PROFILE = Path(__file__).with_name('fastdds_network.xml')

_PROFILE_VARIABLES = ('FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE')
_PROFILE_IN_DIRECTORY = 'DEFAULT_FASTRTPS_PROFILES.xml'
_OTHER_SETTINGS = ('RMW_FASTRTPS_USE_QOS_FROM_XML', 'ROS_DISCOVERY_SERVER')
_TRANSPORTS = 'FASTDDS_BUILTIN_TRANSPORTS'
_RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
_OTHER_DISCOVERY = ('ROS_LOCALHOST_ONLY', 'ROS_STATIC_PEERS')
_FAST_DDS = 'rmw_fastrtps'
_LOG_VARIABLES = ('ROS_LOG_DIR', 'ROS_HOME')


def set_defaults(
        environment: MutableMapping[str, str] = os.environ,
        middleware: str | None = None) -> None:
    """
    Use a packaged Fast DDS profile and limit discovery to this host, unless set by the user.

    Without a home directory that can be written, the log files of ROS are temporary ones: rclpy
    does not start without them.

    ``middleware``: None for the one in use. Fast DDS 2 reads the first of the two variables of a
    profile, Fast DDS 3 the second.

    Raises
    ------
    ConfigError
        A profile set by the user is not a file, or a variable of the discovery has an invalid
        value; the middleware itself would ignore both.

    """
    refuse_invalid(environment)
    for name in _PROFILE_VARIABLES:
        if name in environment and not Path(environment[name]).is_file():
            raise ConfigError(f'{name} = {environment[name]}: no such file')
    if not any(name in environment for name in _LOG_VARIABLES) and not _can_log():
        environment[_LOG_VARIABLES[0]] = str(
            Path(tempfile.gettempdir()) / f'isa_ros-{os.geteuid()}' / 'log')
    if not any(name in environment for name in (_RANGE, *_OTHER_DISCOVERY)):
        environment[_RANGE] = 'LOCALHOST'
    if _has_settings(environment):
        return
    profile = NETWORK_PROFILE
    if _is_for_this_host(environment):
        if (middleware or middleware_name()).startswith(_FAST_DDS):
            # For LOCALHOST the middleware adds transports to those of a profile: UDP that
            # listens on every interface, and shared memory that remains after a SIGKILL.
            environment[_RANGE] = 'SYSTEM_DEFAULT'
            profile = LOCALHOST_PROFILE
    else:
        environment.setdefault(_TRANSPORTS, 'UDPv4')
    for name in _PROFILE_VARIABLES:
        environment[name] = str(profile)


@contextmanager
def defaults(environment: MutableMapping[str, str] = os.environ) -> Iterator[None]:
    """Set the defaults within the context and restore the environment after it."""
    before = dict(environment)
    try:
        set_defaults(environment)
        yield
    finally:
        for name in (*_PROFILE_VARIABLES, _TRANSPORTS, _RANGE, *_LOG_VARIABLES):  # all it sets
            if name in before:
                environment[name] = before[name]
            else:
                environment.pop(name, None)


def middleware_name() -> str:
    """Return the name of the middleware that rclpy uses."""
    name: str = get_rmw_implementation_identifier()
    return name


def finds_other_hosts(environment: Mapping[str, str]) -> bool:
    """Return whether nodes of other hosts can be discovered, after `set_defaults`."""
    is_here = (
        environment.get(_RANGE) in ('LOCALHOST', 'OFF')
        or environment.get('ROS_LOCALHOST_ONLY') == '1'
        or str(LOCALHOST_PROFILE) in (environment.get(name) for name in _PROFILE_VARIABLES))
    return not is_here


def _can_log() -> bool:
    """Return whether the middleware can make its log directory, below HOME."""
    home = os.environ.get('HOME')
    if not home:
        return False
    logs = Path(home) / '.ros' / 'log'
    nearest = next(path for path in (logs, *logs.parents) if path.exists())
    return nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)


def _has_settings(environment: MutableMapping[str, str]) -> bool:
    """Return whether the user has a profile or a setting that replaces one."""
    return (any(name in environment for name in (*_PROFILE_VARIABLES, *_OTHER_SETTINGS))
            or Path(_PROFILE_IN_DIRECTORY).exists())


def _is_for_this_host(environment: MutableMapping[str, str]) -> bool:
    """Return whether discovery is limited to this host and the transports are not set."""
    return environment.get(_RANGE) == 'LOCALHOST' and not any(
        name in environment for name in (_TRANSPORTS, *_OTHER_DISCOVERY))
