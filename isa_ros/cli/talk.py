"""`isa echo`, `isa set` and `isa command`: talk to running nodes where there is no `ros2`."""

import argparse
from argparse import Namespace

from isa_ros.cli.shared_arguments import count, not_negative, number, positive
from isa_ros.errors import ConfigError

TIMEOUT_S = 5.0
REFERENCES = ('current', 'spool', 'pressure')    # without numba, which core.device imports
GAINS = ('stiffness', 'damping')
REQUESTS = ('enable', 'disable', 'clear_fault', 'quick_stop')

_IN_SI = 'in SI: m, N or Pa, for a rotary actuator rad, Nm'


def echo_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa echo`."""
    parser.add_argument('topic', metavar='TOPIC', nargs='?',
                        help='such as ram/joint_states (default: list all topics)')
    parser.add_argument('--count', type=count, metavar='N',
                        help='end after so many messages, of those that are kept the last ones '
                             '(default: until Ctrl-C)')
    _timeout(parser)


def set_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa set`."""
    parser.add_argument('node', metavar='NODE', help='an actuator by its name, or another node')
    parser.add_argument('changes', metavar='KEY[=VALUE]', nargs='+',
                        help='a parameter as isa params lists it; without a value it is shown')
    _timeout(parser)


def command_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa command`."""
    parser.add_argument('actuator', metavar='NAME', help='its name, with its namespace')
    parser.add_argument('position', metavar='POSITION', nargs='?', type=number,
                        help=f'where it shall be; numbers are {_IN_SI}')
    for name in ('velocity', 'effort'):
        parser.add_argument(f'--{name}', type=number, metavar='V', help='feed-forward')
    for name in GAINS:
        parser.add_argument(f'--{name}', type=not_negative, metavar='K',
                            help='of the impedance (default: unchanged)')
    for name in REFERENCES:
        parser.add_argument(f'--{name}', type=number, metavar='V',
                            help=f'setpoint of the mode {name}, instead of a position')
    what = parser.add_mutually_exclusive_group()
    for name in REQUESTS:
        what.add_argument(f'--{name.replace("_", "-")}', action='store_const', const=name,
                          dest='request', help='a request to its device, instead of a setpoint')
    _timeout(parser)
    parser.epilog = (
        'Exits with 1 if the device declines a request or follows no setpoint, 3 after the '
        'timeout.')


def _timeout(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--timeout', type=positive, default=TIMEOUT_S, metavar='S',
        help=f'longest wait in s of host time (default: {TIMEOUT_S:g}); then exit code 3')


def echo(options: Namespace) -> bool:
    """Print the messages of a topic, or the names of all topics."""
    from isa_ros.nodes.terminal.echo import echo as echo_topic, topics
    if options.topic is None:
        topics(options.timeout, _print)
    else:
        echo_topic(options.topic, options.count, options.timeout, _print)
    return True


def set_values(options: Namespace) -> bool:
    """Set or show ROS parameters of a node."""
    from isa_ros.nodes.terminal.parameters import change_of, set_parameters
    set_parameters(options.node, list(map(change_of, options.changes)), options.timeout, _print)
    return True


def command(options: Namespace) -> bool:
    """Send a setpoint or a request to an actuator, and print what became of it."""
    from isa_ros.nodes.terminal.setpoints import command as send, request, GivenSetpoint
    values = vars(options)
    wanted = GivenSetpoint(
        options.position, options.velocity, options.effort,
        {name: values[name] for name in GAINS if values[name] is not None},
        {name: values[name] for name in REFERENCES if values[name] is not None})
    is_setpoint = wanted.is_motion or bool(wanted.references)
    if is_setpoint == bool(options.request) or (wanted.gains and not wanted.is_motion):
        raise ConfigError(
            'needs either a setpoint (POSITION, --velocity, --effort, '
            f'{", ".join(f"--{name}" for name in REFERENCES)}) or a request to the device; gains '
            'alone are set by isa set NAME reu.position.stiffness=VALUE')
    if options.request:
        return request(options.actuator, options.request, options.timeout, _print)
    return send(options.actuator, wanted, options.timeout, _print)


def _print(line: str) -> None:
    print(line, flush=True)
