"""
Where a slave's mailboxes and process data are in its memory.

Each buffer of process data has room for three copies, as buffered sync managers of hardware need.
"""

from typing import NamedTuple

MAILBOX_LENGTH = 256


class Area(NamedTuple):
    """Buffer of a sync manager."""

    start: int
    length: int
    """Bytes; of process data the most there can be."""
    control: int
    """Control register of its sync manager."""


AREAS = (
    Area(0x1000, MAILBOX_LENGTH, 0x26),
    Area(0x1100, MAILBOX_LENGTH, 0x22),
    Area(0x1200, 0x0400, 0x64),
    Area(0x1E00, 0x0400, 0x20))
"""By sync manager: mail from the master and to it, process data from it (watched) and to it."""
