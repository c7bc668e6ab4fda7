"""What tests of shortcuts through numba share."""

from isa_ros.core.shortcuts import Shortcut, SHORTCUTS
from numba.core import ir

HERE = ir.Loc('here.py', 3)


def shortcut(name: str) -> Shortcut:
    """Return a shortcut by the name of what it replaces."""
    found = [own for own in SHORTCUTS if f'{own.owner.__name__}.{own.name}' == name]
    assert len(found) == 1
    return found[0]


def shortened(name: str, own: object = None) -> object:
    """Return what a shortcut puts in the place of numba's function, or of another one."""
    taken = shortcut(name)
    return taken.taken(taken.own if own is None else own)
