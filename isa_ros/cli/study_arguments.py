"""The arguments of `isa study`."""

import argparse

from isa_ros.cli.argument_types import directory_to_write, file_to_write, number


def study(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa study`."""
    parser.add_argument(
        'name', metavar='NAME', nargs='?', help='a study; without one they are listed')
    parser.add_argument('--all', action='store_true', help='run all of them, about a minute')
    parser.add_argument('--model', metavar='M', help='of this actuator only')
    parser.add_argument(
        '--values', type=number, nargs='+', metavar='V',
        help='other values than those of the study, in the unit its table shows')
    parser.add_argument(
        '--json', type=file_to_write, metavar='FILE', help='write the numbers there too')
    parser.add_argument(
        '--out', type=directory_to_write, metavar='DIR',
        help='write studies.md and its figures there')
