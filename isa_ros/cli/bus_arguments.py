"""The arguments of `isa bus`: a bus, or `describe`."""

import argparse
from pathlib import Path

from isa_ros.cli.argument_types import count, file_to_write, positive
from isa_ros.cli.run_arguments import run_options
from isa_ros.fieldbus import request
from isa_ros.run.options import OPTIONS

DESCRIBE = 'describe'


def bus(parser: argparse.ArgumentParser) -> None:
    """Add the buses as commands of their own."""
    below = parser.add_subparsers(metavar='BUS', dest='bus', required=True)
    for name, (add_arguments, summary) in _BUSES.items():
        own = below.add_parser(name, help=summary, description=summary)
        add_arguments(own)
        own.add_argument(
            '--debug', action='store_true', default=argparse.SUPPRESS,
            help='show the traceback of an error')


def _ethercat(parser: argparse.ArgumentParser) -> None:
    _run(parser)
    parser.add_argument(
        '--interface', required=True, metavar='IF',
        help='network interface of the ring, for example one end of a veth pair')


def _can(parser: argparse.ArgumentParser) -> None:
    _run(parser)
    parser.add_argument(
        '--interface', required=True, metavar='NAME',
        help='interface of python-can: udp_multicast, socketcan, slcan, ...')
    parser.add_argument('--channel', required=True, help='of that interface')
    parser.add_argument(
        '--bitrate', type=count, default=request.OF_THE_WIRE, metavar='BIT/S',
        help='of the bus (default: 1000000)')
    parser.add_argument(
        '--first-node', type=count, default=1, metavar='N',
        help='number of the first actuator (default: %(default)s)')


def _serial(parser: argparse.ArgumentParser) -> None:
    _run(parser)
    parser.add_argument(
        '--path', type=Path, required=True, metavar='FILE',
        help='serial device, or a link to make to a pseudo terminal')
    parser.add_argument(
        '--baud', type=count, default=request.OF_THE_WIRE, metavar='BIT/S',
        help='of the line (default: that of docs/link.md)')


def _describe(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('config', metavar='CONFIG', help='a run file, or a shipped one by name')
    _profile(parser)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        '--esi', type=file_to_write, metavar='FILE.xml', help='write the XML file of EtherCAT')
    what.add_argument(
        '--eds', type=file_to_write, metavar='FILE.eds',
        help='write the data sheet of CANopen; for each of several actuators a FILE_NAME.eds')
    what.add_argument('--table', action='store_true', help='print all objects')


def _run(parser: argparse.ArgumentParser) -> None:
    """Add the options that every bus has."""
    run_options(parser, [option for option in OPTIONS if option.is_of_bus])
    _profile(parser)
    parser.add_argument(
        '--pace', choices=request.PACES, default=request.FRAME,
        help='frame: a cycle of the master is a tick; real_time: a tick is 1 ms of host time, or '
        'the step of CONFIG (default: %(default)s)')
    parser.add_argument(
        '--watchdog-ms', type=positive, default=request.WATCHDOG_MS, metavar='MS',
        help='silence after which the bus counts as lost, in real-time pace '
        '(default: %(default)g)')
    parser.add_argument(
        '--no-ros', action='store_true', help='no nodes: only the bus and the bag, the same bytes')


def _profile(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--profile', choices=request.PROFILES, default=request.PROFILES[0],
        help='of the devices (default: %(default)s)')


_BUSES = {
    request.ETHERCAT: (_ethercat, 'serve an EtherCAT master on a network interface'),
    request.CANOPEN: (_can, 'serve a CANopen master on a CAN interface'),
    request.MIT: (_can, 'serve a master of MIT-mode motors on a CAN interface'),
    request.SERIAL: (_serial, 'serve a master on a serial line'),
    DESCRIBE: (_describe, 'write what a master wants to know of the devices'),
}
