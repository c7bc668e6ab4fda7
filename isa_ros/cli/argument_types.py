"""Types of command-line arguments; invalid values give one-line errors."""

import argparse
import math
import os
from pathlib import Path


def positive(text: str) -> float:
    """Return a finite number > 0."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r} must be a number > 0')
    return value


def not_negative(text: str) -> float:
    """Return a finite number >= 0."""
    value = number(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f'{text!r} must be a number >= 0')
    return value


def number(text: str) -> float:
    """Return a finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f'{text!r} must be a number')
    return value


def count(text: str) -> int:
    """Return a whole number > 0."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f'{text!r} must be a whole number > 0')
    return value


def seed(text: str) -> int:
    """Return a whole number >= 0; its upper bound is that of the run file's key."""
    try:
        value = int(text)
    except ValueError:
        value = -1
    if value < 0:
        raise argparse.ArgumentTypeError(f'{text!r} must be a whole number >= 0')
    return value


def names(text: str) -> tuple[str, ...]:
    """Return names from a text in which commas separate them."""
    found = tuple(text.split(','))
    if not all(found):
        raise argparse.ArgumentTypeError(f'{text!r} must be names separated by commas')
    return found


def file_to_write(text: str) -> Path:
    """Return the path of a file that can be written; it is checked before a long measurement."""
    path = Path(text)
    if path.is_dir():
        raise argparse.ArgumentTypeError(f'{text} is a directory, must be a file')
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f'{text}: the directory {path.parent} does not exist')
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f'{text} is not writable')
    return path


def directory_to_write(text: str) -> Path:
    """Return the path of a directory that can be written or created."""
    path = Path(text)
    nearest = next(place for place in [path, *path.absolute().parents] if place.exists())
    if not nearest.is_dir():
        raise argparse.ArgumentTypeError(f'{text}: {nearest} is a file, must be a directory')
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise argparse.ArgumentTypeError(f'{text}: {nearest} is not writable')
    return path
