"""Types of command-line arguments; a wrong one is answered in one line."""

import argparse
import math


def positive(text: str) -> float:
    """Return a finite number > 0."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r} must be a number > 0')
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
