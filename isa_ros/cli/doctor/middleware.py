"""ROS on this host: rclpy, the middleware, the domain and how far discovery reaches."""

from collections.abc import Iterator, Mapping
from importlib.util import find_spec
import os
from pathlib import Path

from isa_ros.cli.doctor.finding import Finding, Verdict
from isa_ros.errors import ConfigError
from isa_ros.processes.domain_id import domain_id, DOMAIN_VARIABLE
from msg_adapters.optional import is_installed, OPTIONAL

TRIED = 'rmw_fastrtps_cpp'
"""The middleware with which isa_ros is tested."""

_GROUP = 'ROS'
_RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'


def middleware(environment: Mapping[str, str] = os.environ) -> Iterator[Finding]:
    """Yield how nodes of this environment would run."""
    found = find_spec('rclpy')
    if found is None or found.origin is None:
        yield Finding(
            _GROUP, 'rclpy', 'missing', Verdict.NOTE,
            'nodes need it: source ROS 2 Jazzy, or use ./isa of a clone; isa_ros.load, '
            'isa replay and analyses work without')
    else:
        distribution = environment.get('ROS_DISTRO', 'from wheels')
        yield Finding(_GROUP, 'rclpy', f'{distribution}, {Path(found.origin).parents[1]}')
        yield _rmw()
        yield from optional()
    yield _domain(environment)
    reach = environment.get(_RANGE, '')
    yield Finding(_GROUP, 'discovery', reach or 'this host (set by isa_ros)') if (
        reach != 'OFF') else Finding(
            _GROUP, 'discovery', 'OFF', Verdict.PROBLEM,
            f'no process finds another: set {_RANGE} to LOCALHOST')


def optional() -> Iterator[Finding]:
    """Yield which message packages that nodes may use are there."""
    for package, purpose in OPTIONAL.items():
        yield Finding(_GROUP, package, 'installed') if is_installed(package) else Finding(
            _GROUP, package, 'not installed', Verdict.NOTE,
            f'only for {purpose}: apt install ros-jazzy-{package.replace("_", "-")}')


def _rmw() -> Finding:
    from isa_ros.nodes.middleware.environment import middleware_name
    name = middleware_name()
    if name == TRIED:
        return Finding(_GROUP, 'middleware', name)
    return Finding(_GROUP, 'middleware', name, Verdict.NOTE,
                   f'tested with {TRIED} only: unset RMW_IMPLEMENTATION')


def _domain(environment: Mapping[str, str]) -> Finding:
    try:
        return Finding(_GROUP, DOMAIN_VARIABLE, str(domain_id(environment)))
    except ConfigError as error:
        return Finding(_GROUP, DOMAIN_VARIABLE, repr(environment[DOMAIN_VARIABLE]),
                       Verdict.PROBLEM, str(error))
