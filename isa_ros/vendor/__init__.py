"""
Code of others that pages contain, unchanged, each with its licence.

`manifest.json` has of each package version, licence, address, integrity of its archive as the
registry states it, and SHA-384 of the files kept here.
"""

from pathlib import Path
from typing import NamedTuple

_HERE = Path(__file__).parent


class Vendored(NamedTuple):
    """The parts of a package that a page contains."""

    script: str
    style: str
    licence: str


def uplot() -> Vendored:
    """Return uPlot, which draws diagrams on a canvas."""
    own = _HERE / 'uplot'
    return Vendored(*((own / name).read_text(encoding='utf-8') for name in (
        'uPlot.iife.min.js', 'uPlot.min.css', 'LICENSE')))
