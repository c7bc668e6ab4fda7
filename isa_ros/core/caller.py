"""Warnings that name a line of the caller's own code."""

from pathlib import Path
import sys
import warnings

_PACKAGE = f'{Path(__file__).parents[1]}/'


def warn(line: str, category: type[Warning] = UserWarning) -> None:
    """Warn with the place of the nearest call from outside of isa_ros."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        level, frame = level + 1, frame.f_back
    warnings.warn(line, category, stacklevel=level)
