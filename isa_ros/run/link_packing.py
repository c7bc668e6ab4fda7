"""
What a link adds to the messages of its actuator.

Messages of its state have the time at which the device sampled it, and ``~/applied_setpoint`` the
plant step at which it took effect. ``~/sent_setpoint`` is what was handed to the link.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.signals import (
    COMMAND, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, Records, SAMPLE)
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP, PLANT_STEP_NS
from msg_adapters.setpoint import applied_setpoint
from msg_adapters.template import FIRST_VALUE, Prepared, stamped
import numpy as np

_SENT = ('is_enabled', 'position', 'velocity', 'effort', 'stiffness', 'damping', 'mode',
         'reference', 'kinds')
_AGE = (SAMPLE.names or ()).index('age')
WORDS = 2 + len(_SENT)
"""Words of one link: times of sampling and of effect, then the values of the sent setpoint."""


@kernel
def time_word_of(t_ns):
    """Return a time as the word of a stamp, as `msg_adapters.template.time_word`."""
    return (t_ns % NS_PER_SECOND) << 32 | t_ns // NS_PER_SECOND


@kernel
def pack_links(t_ns, tick_start_ns, start_ns, links, samples, applied, words, values):
    """
    Write the words of all ``links``, a `PackedLinks`.

    ``samples`` are the floats of every `SAMPLE`, ``applied`` `COMMAND` rows; ``start_ns`` is the
    time of stamps at t = 0.
    """
    at = links.first[0]
    for row in links.rows:
        words[at] = time_word_of(
            start_ns + t_ns - int(samples[row, _AGE] / PLANT_STEP + 0.5) * PLANT_STEP_NS)
        due = applied[row].due_step
        words[at + 1] = time_word_of(
            start_ns + (due * PLANT_STEP_NS if due > 0 else tick_start_ns))
        command = links.sent[row]
        kinds = command.kinds
        for k in range(2, WORDS):
            values[at + k] = np.nan
        if kinds & HAS_ENABLE:
            values[at + 2] = float(command.is_enabled)
        if kinds & HAS_SETPOINT:
            values[at + 3] = command.position
            values[at + 4] = command.velocity
            values[at + 5] = command.effort
        if kinds & (HAS_SETPOINT | HAS_GAINS):
            values[at + 6] = command.stiffness
            values[at + 7] = command.damping
        if kinds & (HAS_MODE | HAS_REFERENCE):
            values[at + 8] = float(command.mode)
        if kinds & HAS_REFERENCE:
            values[at + 9] = command.reference
        values[at + 10] = float(kinds)
        at += WORDS


class PackedLinks(NamedTuple):
    """Of the actuators with a link."""

    rows: np.ndarray
    """int64, (l,)."""
    first: np.ndarray
    """Place of their first word, int64, (1,)."""
    sent: np.ndarray
    """`COMMAND` handed to a link, (n,)."""


class LinkWords:
    """
    The words of the links of some actuators, behind all other words of a template.

    ``rows`` are the actuators with a link, ``first`` the first column of their words; ``sent``
    are the `COMMAND` handed to the links, (n,), None: there are none.
    """

    def __init__(self, rows: Sequence[int], first: int, sent: Records | None, n: int) -> None:
        self.sent: Records = np.zeros(n, COMMAND) if sent is None else sent
        """`COMMAND` handed to a link, kinds 0 without one, (n,)."""
        self.rows = () if sent is None else tuple(rows)
        self.n_words = len(self.rows) * WORDS
        self._first = first
        self.memory = PackedLinks(
            np.array(self.rows, np.int64), np.array([FIRST_VALUE + first], np.int64), self.sent)
        """For the kernel."""

    def messages(
            self, row: int, name: str, messages: Mapping[str, Prepared]) -> dict[str, Prepared]:
        """Return the messages of an actuator, with what its link adds if it has one."""
        if row not in self.rows:
            return dict(messages)
        first = self._first + WORDS * self.rows.index(row)
        sent = {field: first + 2 + k for k, field in enumerate(_SENT)}
        own = {suffix: stamped(message, first + (suffix == 'applied_setpoint'))
               for suffix, message in messages.items()}
        return own | {'sent_setpoint': applied_setpoint(name, sent)}
