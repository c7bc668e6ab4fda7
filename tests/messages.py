"""Prepared messages filled with plain numbers, as the tests need them."""

from collections.abc import Sequence

from isa_ros.core.signals import COMMAND, SAMPLE
from msg_adapters import actuator_messages, setpoint
from msg_adapters.template import (
    FIRST_VALUE, INSTANT, Prepared, Template, TICK_START, time_word)
import numpy as np

APPLIED = tuple(name for name in COMMAND.names or () if name != 'due_step')
"""Fields of an applied setpoint, in the order of `COMMAND`."""

VALUES = tuple(
    [f'sample {field}' for field in SAMPLE.names or ()]
    + [f'absolute pressure_{chamber}' for chamber in 'ab']
    + [f'applied {field}' for field in APPLIED])
"""The values of one actuator's messages, in their order."""


def fill(template: Template, values: Sequence[float], t_ns: int, start_ns: int = 0) -> None:
    """Fill a template with values, the time of the instant and that of its tick's start."""
    words = np.zeros(FIRST_VALUE + len(values), np.uint64)
    words[INSTANT], words[TICK_START] = time_word(t_ns), time_word(start_ns)
    words.view(np.float64)[FIRST_VALUE:] = values
    template.fill(words)


def packed(
        messages: Sequence[Prepared], values: Sequence[float], t_ns: int,
        start_ns: int = 0) -> list[bytes]:
    """Return the CDR bytes of prepared messages, in their order."""
    template = Template(messages)
    fill(template, values, t_ns, start_ns)
    return [template.message(k) for k in range(len(messages))]


def of_actuator(name: str, is_rotary: bool, first: int = 0) -> dict[str, Prepared]:
    """Return the prepared messages of an actuator whose `VALUES` begin at column ``first``."""
    columns = {value: first + k for k, value in enumerate(VALUES)}
    sample, absolute, applied = (
        {value.removeprefix(source): column for value, column in columns.items()
         if value.startswith(source)}
        for source in ('sample ', 'absolute ', 'applied '))
    return actuator_messages.prepared(name, is_rotary, sample, absolute, applied)


def applied_setpoint(name: str, command: np.void, t_ns: int) -> bytes:
    """Return the applied setpoint of a `COMMAND` row in force from ``t_ns`` on."""
    columns = {field: k for k, field in enumerate(APPLIED)}
    data, = packed([setpoint.applied_setpoint(name, columns)],
                   [float(command[field]) for field in APPLIED], 0, t_ns)
    return data
