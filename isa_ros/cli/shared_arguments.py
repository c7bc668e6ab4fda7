"""Arguments of several commands, and types of arguments; invalid values give one-line errors."""

import argparse
from collections.abc import Callable
import json
import math
import os
from pathlib import Path

from isa_ros.core.suggest import shortened

PNG = b'\x89PNG\r\n\x1a\n'
"""How a PNG file begins."""
MOST_PORT = 65535


def bag(parser: argparse.ArgumentParser, name: str = 'bag') -> None:
    """Add a bag to read."""
    parser.add_argument(name, type=Path, metavar='BAG')


def json_file(parser: argparse.ArgumentParser, what: str = 'the numbers') -> None:
    """Add the JSON file for the printed numbers."""
    parser.add_argument(
        '--json', type=json_to_write, metavar='FILE', help=f'also write {what} to a file')


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


def positive(text: str) -> float:
    """Return a finite number > 0."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{_quoted(text)} must be a number > 0')
    return value


def not_negative(text: str) -> float:
    """Return a finite number >= 0."""
    value = number(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f'{_quoted(text)} must be a number >= 0')
    return value


def number(text: str) -> float:
    """Return a finite number."""
    try:
        value = math.nan if '_' in text else float(text)    # Python takes 1_0 as 10
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f'{_quoted(text)} must be a number')
    return value


def count(text: str) -> int:
    """Return a whole number > 0."""
    return _whole(text, 1, '> 0')


def seed(text: str) -> int:
    """Return a whole number >= 0; its upper bound is that of the run file's key."""
    return _whole(text, 0, '>= 0')


def _whole(text: str, least: int, bound: str) -> int:
    try:
        value = least - 1 if '_' in text else int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise argparse.ArgumentTypeError(f'{_quoted(text)} must be a whole number {bound}')
    return value


def _quoted(text: str) -> str:
    return shortened(repr(text))


def port(text: str) -> int:
    """Return a port of TCP; 0: any that is free."""
    value = _whole(text, 0, f'from 0 to {MOST_PORT}')
    if value > MOST_PORT:
        raise argparse.ArgumentTypeError(
            f'{_quoted(text)} must be a whole number from 0 to {MOST_PORT}')
    return value


def names(text: str) -> tuple[str, ...]:
    """Return names from a text in which commas separate them."""
    found = tuple(text.split(','))
    if not all(found):
        raise argparse.ArgumentTypeError(f'{_quoted(text)} must be names separated by commas')
    return found


def file_to_write(text: str) -> Path:
    """Return the path of a file that can be written; it is checked before a long measurement."""
    path = Path(text)
    if path.is_dir():
        raise argparse.ArgumentTypeError(f'{text} is a directory, must be a file')
    if path.exists() and not path.is_file():
        raise argparse.ArgumentTypeError(f'{text} is a device or a pipe, must be a file')
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f'{text}: the directory {path.parent} does not exist')
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f'{text} is not writable')
    return path


def json_to_write(text: str) -> Path:
    """Return the path of a JSON file that can be written; no other file is replaced by it."""
    path = file_to_write(text)
    if path.exists():
        try:
            json.loads(path.read_bytes() or b'{}')
        except ValueError:
            raise argparse.ArgumentTypeError(
                f'{text} already exists and is not JSON, so it is not overwritten') from None
    return path


def like_before(what: str, *heads: bytes) -> Callable[[str], Path]:
    """
    Return what gives the path of a file that can be written.

    One that is there is replaced if it is empty or begins with one of ``heads``, as what is
    written does: ``what``, in words.
    """
    def own(text: str) -> Path:
        path = file_to_write(text)
        if path.exists():
            with path.open('rb') as file:
                found = file.read(max(map(len, heads)))
            if found and not found.startswith(heads):
                raise argparse.ArgumentTypeError(
                    f'{text} already exists and is not {what}, so it is not overwritten')
        return path
    return own


figure_to_write = like_before('a PNG', PNG)
"""Returns the path of a figure."""


def directory_to_write(text: str) -> Path:
    """Return the path of a directory that can be written or created."""
    path = Path(text)
    nearest = next(place for place in [path, *path.absolute().parents] if place.exists())
    if not nearest.is_dir():
        raise argparse.ArgumentTypeError(f'{text}: {nearest} is a file, must be a directory')
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise argparse.ArgumentTypeError(f'{text}: {nearest} is not writable')
    return path
