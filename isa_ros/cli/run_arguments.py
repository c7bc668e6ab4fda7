"""The arguments of `isa bringup`, and of `isa bus`: a bus, or `describe`."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from isa_ros.cli import shared_arguments
from isa_ros.cli.shared_arguments import (
    count, json_to_write, like_before, names, not_negative, positive, seed)
from isa_ros.fieldbus import request
from isa_ros.run.option import COMPRESSIONS, Kind, Option
from isa_ros.run.options import OPTIONS

DESCRIBE = 'describe'

_TYPES: Mapping[Kind, Callable[[str], Any]] = {
    Kind.PATH: Path, Kind.NEW_FILE: json_to_write, Kind.POSITIVE: positive,
    Kind.LIMIT: not_negative, Kind.NOT_NEGATIVE: not_negative, Kind.WHOLE: seed, Kind.NAMES: names}
"""Checks of a value by kind; other kinds are texts."""


def bringup(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa bringup`."""
    run_options(parser, OPTIONS)


def run_options(parser: argparse.ArgumentParser, options: Sequence[Option]) -> None:
    """Add options of a run, where they are for the command line."""
    for option in options:
        if option.is_argument:
            _add(parser, option)


def _add(parser: argparse.ArgumentParser, option: Option) -> None:
    how: dict[str, Any] = {'help': option.argument_help}
    flag = f'--{option.name.replace("_", "-")}'
    if option.is_required:
        parser.add_argument(option.name, metavar=option.metavar, **how)
    elif option.kind is Kind.FLAG:
        parser.add_argument(flag, action='store_true', **how)
    elif option.kind is Kind.COMPRESSION:
        parser.add_argument(flag, choices=COMPRESSIONS, **how)
    elif option.kind is Kind.CHANGES:
        shared_arguments.changes(parser, option.argument_help)
    elif option.kind is Kind.REPEATED:
        parser.add_argument(
            flag, dest=option.name, action='append', default=[], metavar=option.metavar, **how)
    else:
        parser.add_argument(flag, type=_TYPES.get(option.kind, str), default=option.default,
                            metavar=option.metavar, **how)


def bus(parser: argparse.ArgumentParser) -> None:
    """Add the buses as commands of their own."""
    below = parser.add_subparsers(metavar='BUS', dest='bus', required=True)
    for name, row in request.BUSES.items():
        own = _command(below, name, f'serve {row.serves}')
        _of_bus(own)
        for argument in row.arguments:
            flag = f'--{argument.name.replace("_", "-")}'
            if argument.kind is bool:
                own.add_argument(flag, action='store_true', help=argument.meaning)
                continue
            own.add_argument(
                flag, metavar=argument.metavar,
                type=count if argument.kind is int else argument.kind, help=argument.meaning,
                required=argument.default is None, default=argument.default)
        _debug(own)
    own = _command(below, DESCRIBE, 'write what a master wants to know of the devices')
    _describe(own)
    _debug(own)


def _command(below: Any, name: str, summary: str) -> argparse.ArgumentParser:
    added: argparse.ArgumentParser = below.add_parser(name, help=summary, description=summary)
    return added


def _debug(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--debug', action='store_true', default=argparse.SUPPRESS,
        help='show the traceback of an error')


def _describe(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('config', metavar='CONFIG', help='a run file, or a shipped one by name')
    shared_arguments.changes(parser, 'replace a value of the run file')
    _profile(parser)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        '--esi', type=like_before('an ESI', b'<?xml'), metavar='FILE.xml',
        help='write the XML file of EtherCAT')
    what.add_argument(
        '--eds', type=like_before('an EDS', b'[FileInfo]'), metavar='FILE.eds',
        help='write the data sheet of CANopen; for each of several actuators a FILE_NAME.eds')
    what.add_argument(
        '--ros2-control', type=shared_arguments.directory_to_write, metavar='DIR',
        help='write the files of ethercat_driver_ros2: slaves, and the tag of ros2_control')
    what.add_argument(
        '--ros2-canopen', type=shared_arguments.directory_to_write, metavar='DIR',
        help='write the files of ros2_canopen: data sheets, bus.yml, and the tag of ros2_control')
    what.add_argument('--table', action='store_true', help='print all objects')


def _of_bus(parser: argparse.ArgumentParser) -> None:
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
