"""The present warnings and trips of an actuator in words, from the records of its protection."""

from collections.abc import Iterator
from typing import NamedTuple

from isa_ros.core.conditions import BITS, REACTIONS, words
import numpy as np


class Report(NamedTuple):
    """One warning or trip."""

    name: str
    """Of the condition."""
    is_trip: bool
    is_first: bool
    """Whether it is the first of the present trips: the cause."""
    since_step: int
    """Plant step at which it was set."""
    reaction: str
    """Of a trip; '' for a warning."""
    text: str
    """What, measured value, level and unit, in words."""


def reports(protection: np.record, state: np.record, is_rotary: bool = False) -> list[Report]:
    """
    Return all trips and warnings of a `PROTECTION` and a `PROTECTION_STATE`.

    The cause is first, then the other trips, then warnings without a trip. The value of a trip is
    the one that caused it, that of a warning the present one.
    """
    found = [*_reports(protection, state, is_rotary, True),
             *_reports(protection, state, is_rotary, False)]
    return sorted(found, key=lambda report: (not report.is_first, not report.is_trip))


def _reports(
        protection: np.record, state: np.record, is_rotary: bool, is_trip: bool
        ) -> Iterator[Report]:
    trips = int(state.trips)
    bits = trips if is_trip else int(state.warnings) & ~trips
    levels = protection.trip if is_trip else protection.warning
    values = state.trip_values if is_trip else state.values
    since = state.trip_since if is_trip else state.warning_since
    for name, k in BITS.items():
        if bits >> k & 1:
            text = words(
                name, float(values[k]), float(protection.sign[k] * levels[k]),
                float(protection.delay[k] * protection.period), is_trip=is_trip,
                is_rotary=is_rotary)
            yield Report(
                name, is_trip, is_trip and bool(int(state.first) >> k & 1), int(since[k]),
                REACTIONS[int(protection.reaction[k])] if is_trip else '', text)
