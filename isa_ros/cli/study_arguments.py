"""The arguments of `isa study`."""

import argparse

from isa_ros.cli import shared_arguments
from isa_ros.cli.argument_types import number


def study(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa study`."""
    parser.add_argument(
        'name', metavar='NAME', nargs='?', help='a study; without one they are listed')
    parser.add_argument('--all', action='store_true', help='run all of them, about a minute')
    parser.add_argument('--model', metavar='M', help='of this actuator only')
    parser.add_argument(
        '--values', type=number, nargs='+', metavar='V',
        help='other values than those of the study, in the unit its table shows')
    shared_arguments.json_file(parser)
    shared_arguments.page_directory(parser, 'studies.md and its figures')
