"""Arguments that several commands have."""

import argparse
from pathlib import Path

from isa_ros.cli.argument_types import directory_to_write, file_to_write


def bag(parser: argparse.ArgumentParser, name: str = 'bag') -> None:
    """Add a bag to read."""
    parser.add_argument(name, type=Path, metavar='BAG')


def json_file(parser: argparse.ArgumentParser, what: str = 'the numbers') -> None:
    """Add the file for what is also printed."""
    parser.add_argument(
        '--json', type=file_to_write, metavar='FILE', help=f'write {what} there too')


def page_directory(parser: argparse.ArgumentParser, page: str) -> None:
    """Add the directory of a page in Markdown."""
    parser.add_argument(
        '--out', type=directory_to_write, metavar='DIR', help=f'write {page} there')


def gains(parser: argparse.ArgumentParser, metavar: str) -> None:
    """Add preset and variants of a model."""
    parser.add_argument(
        '--preset', metavar=metavar, help='gains of a model (default: default)')
    parser.add_argument(
        '--variant', action='append', default=[], metavar='V',
        help='another way to model or to wire a model; may be repeated')
