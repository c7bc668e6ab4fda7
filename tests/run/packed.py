"""Rows to pack, and what is packed of them by topic."""

from collections.abc import Sequence

from isa_ros.core.device import FIELDS
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.run.packing import Packer
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import PublishedRows
import numpy as np

HELD, MAIN = ('supply', ('pressure',)), ('main', ('pressure', 'return_pressure'))
"""Names of supplies with what they publish."""
TICK_NS, T_NS = 6_000_000, 7_000_000
ATMOSPHERE = 101325.0  # Pa, ISO 2533


def some_rows(n: int = 2, n_supplies: int = 1) -> PublishedRows:
    """Return rows whose numbers all differ but those of the device; nothing is applied."""
    samples, supplies = np.zeros(n, SAMPLE), np.zeros(n_supplies, SUPPLY_SAMPLE)
    samples.view(np.float64)[:] = np.arange(1.0, len(SAMPLE.names) * n + 1)
    supplies.view(np.float64)[:] = 1e6 * np.arange(1.0, len(SUPPLY_SAMPLE.names) * n_supplies + 1)
    for field in (*FIELDS, 'age'):
        samples[field] = 0.0
    return PublishedRows(samples, np.zeros(n, COMMAND), supplies, {})


def named(packer: Packer, messages: Sequence[tuple[int, bytes]]) -> list[tuple[str, bytes]]:
    return [(packer.topics[k].name, data) for k, data in messages]


def everything(packer: Packer, events: Sequence[bytes] = ()) -> dict[str, bytes]:
    """Return what is packed by topic; each topic comes once."""
    messages = named(packer, packer.all_messages(events))
    assert len({name for name, _ in messages}) == len(messages)
    return dict(messages)
