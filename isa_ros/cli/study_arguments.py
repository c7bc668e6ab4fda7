"""The arguments of `isa study`."""

import argparse

from isa_ros.cli import shared_arguments
from isa_ros.cli.argument_types import number


def study(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa study`."""
    parser.add_argument(
        'name', metavar='NAME', nargs='?', help='a study (default: list all studies)')
    parser.add_argument(
        '--all', action='store_true', help='run those of studies.md, about a minute')
    parser.add_argument('--model', metavar='M', help='only this actuator (default: all)')
    parser.add_argument(
        '--values', type=number, nargs='+', metavar='V',
        help='values instead of those of the study, in the unit of its table')
    shared_arguments.json_file(parser)
    shared_arguments.page_directory(parser, 'studies.md and its figures, or temperature.md')
