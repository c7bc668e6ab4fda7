"""Arguments of several commands."""

import argparse
from pathlib import Path

from isa_ros.cli.argument_types import directory_to_write, file_to_write


def bag(parser: argparse.ArgumentParser, name: str = 'bag') -> None:
    """Add a bag to read."""
    parser.add_argument(name, type=Path, metavar='BAG')


def json_file(parser: argparse.ArgumentParser, what: str = 'the numbers') -> None:
    """Add the JSON file for the printed numbers."""
    parser.add_argument(
        '--json', type=file_to_write, metavar='FILE', help=f'also write {what} to a file')


def page_directory(parser: argparse.ArgumentParser, page: str) -> None:
    """Add the directory of a page in Markdown."""
    parser.add_argument(
        '--out', type=directory_to_write, metavar='DIR', help=f'directory for {page}')


def changes(parser: argparse.ArgumentParser, what: str) -> None:
    """Add values that replace those of a model or a run file."""
    parser.add_argument(
        '--set', action='append', default=[], metavar='KEY=VALUE', help=f'{what}; may be repeated')


def gains(parser: argparse.ArgumentParser, metavar: str) -> None:
    """Add preset and variants of a model."""
    parser.add_argument(
        '--preset', metavar=metavar, help='gains of a model (default: default)')
    parser.add_argument(
        '--variant', action='append', default=[], metavar='V',
        help='variant of the equations or of the wiring of a model; may be repeated')
