"""Two messages of `/diagnostics` side by side: values by status and key, and as numbers."""

from collections.abc import Iterator, Mapping
import math
from typing import Any

from isa_ros.replay.difference import ABSENT, PRESENT
from msg_adapters.cdr import Message
from msg_adapters.diagnostics import MESSAGE, texts_of

Statuses = Mapping[str, Mapping[str, str]]


def differing_values(one: Message, other: Message) -> Iterator[tuple[str, Any, Any]]:
    """
    Yield (field, expected, actual) of what differs, ``ram: oil and energy, mean_power_w``.

    Numbers are floats where both are. Messages come last. Nothing is yielded of other messages,
    and of what the order of statuses tells.
    """
    first, second = texts_of(one), texts_of(other)
    if first is None or second is None:
        return
    told: list[tuple[str, Any, Any]] = []
    for name in {**first, **second}:
        if name not in first or name not in second:
            yield name, _presence(name, first), _presence(name, second)
            continue
        for key in {**first[name], **second[name]}:
            values = [own[name].get(key, ABSENT) for own in (first, second)]
            if values[0] != values[1]:
                found = (f'{name}, {key}', *_as_numbers(*values))
                if key == MESSAGE:
                    told.append(found)
                else:
                    yield found
    yield from told


def _presence(name: str, among: Statuses) -> str:
    return PRESENT if name in among else ABSENT


def _as_numbers(expected: str, actual: str) -> tuple[Any, Any]:
    """Return two texts as numbers if both are, and are not the same one."""
    try:
        one, other = float(expected), float(actual)
    except ValueError:
        return expected, actual
    is_other = one != other and not (math.isnan(one) and math.isnan(other))
    return (one, other) if is_other else (expected, actual)
