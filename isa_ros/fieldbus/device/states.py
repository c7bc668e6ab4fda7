"""Tables of states of the profiles: their rows, and what follows from them."""

from collections.abc import Iterable, Mapping
from enum import Enum
from typing import NamedTuple


class DeviceState(Enum):
    """Base of a profile's states: name, bits of the status word, and how far it is, from 0."""

    def __init__(self, words: str, bits: int, level: int = 0) -> None:
        self.words = words
        self.bits = bits
        self.level = level


class Transition(NamedTuple):
    """One row of the table of states."""

    number: int | str
    """Of the profile; '': none."""
    state: DeviceState
    event: Enum
    guard: str
    """A condition besides the event; '': none."""
    following: DeviceState
    does: str


Following = Mapping[tuple[DeviceState, Enum], tuple[Transition, ...]]
"""The rows of each state and event; the first whose guard holds counts."""


def following(transitions: Iterable[Transition]) -> Following:
    """Return the rows by state and event; an event without a row for a state is ignored there."""
    found: dict[tuple[DeviceState, Enum], tuple[Transition, ...]] = {}
    for row in transitions:
        found[row.state, row.event] = (*found.get((row.state, row.event), ()), row)
    return found
