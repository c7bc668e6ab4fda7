"""A small recorded run for the bag tests: one actuator, a clock, exact numbers."""

from collections.abc import Callable, Iterator
from pathlib import Path
import threading
import time

from isa_ros.bag.provenance import Provenance
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.signals import SAMPLE
from isa_ros.core.topic import KEPT, Topic
from msg_adapters import clock
from msg_adapters.actuator_messages import APPLIED_SETPOINT, STATE_TOPICS
from msg_adapters.template import Template
import numpy as np
from tests.messages import APPLIED, fill, of_actuator

STEP_NS = 1_000_000
DEADLINE_S, LOOK_S = 20.0, 0.002
PROVENANCE = Provenance(
    configuration='name: rig\n', scenario='name: step\n', seed=7,
    versions={'isa_ros': '0.1.0', 'numpy': '2.0'})
TOPICS = tuple(sorted(
    [Topic(*clock.TOPIC), Topic('/hip/applied_setpoint', APPLIED_SETPOINT[1], KEPT)]
    + [Topic(f'/hip/{suffix}', type_name) for suffix, type_name in STATE_TOPICS],
    key=lambda topic: topic.name))
NAMES = [topic.name for topic in TOPICS]
MESSAGES = of_actuator('hip', is_rotary=True)
TEMPLATE = Template(list(MESSAGES.values()))


def tick_messages(tick, **changed):
    """Return (topic index, bytes) of tick 0, 1, ...; ``changed`` replaces sample fields."""
    t_ns = tick * STEP_NS
    sample = np.zeros(1, dtype=SAMPLE)
    for k, field in enumerate(SAMPLE.names):
        sample[field] = np.sin(0.1 * tick + k)
    for field, value in changed.items():
        sample[field] = value
    absolute = [sample[0][f'pressure_{chamber}'] + ATMOSPHERE for chamber in 'ab']
    fill(TEMPLATE, [*sample.item(), *absolute, *np.zeros(len(APPLIED))], t_ns, t_ns)
    produced = {'/clock': clock.pack(t_ns)} | {
        f'/hip/{suffix}': TEMPLATE.message(k) for k, suffix in enumerate(MESSAGES)}
    if tick % 100:
        del produced[f'/hip/{APPLIED_SETPOINT[0]}']
    return [(NAMES.index(name), produced[name]) for name in sorted(produced)]


def record(directory: Path, n_ticks: int, changed=None, **options) -> Path:
    """Record ``n_ticks`` and return the MCAP file; ``changed`` maps ticks to fields."""
    with BagWriter(directory, TOPICS, PROVENANCE, **options) as writer:
        for tick in range(n_ticks):
            fields = (changed or {}).get(tick, {})
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick, **fields))
    return writer.path


def expected(n_ticks: int) -> Iterator[tuple[str, int, bytes]]:
    """Yield (topic, time, bytes) as they are handed to the writer of ``n_ticks``."""
    for tick in range(n_ticks):
        for k, data in tick_messages(tick):
            yield NAMES[k], tick * STEP_NS, data


def files(directory: Path) -> list[Path]:
    """Return the MCAP files of a bag of less than eleven, in their order."""
    return sorted(directory.glob('*.mcap'))


def contents(directory: Path) -> dict[str, bytes]:
    """Return the content of every file by name."""
    return {path.name: path.read_bytes() for path in directory.iterdir()}


def wait_for_disk(directory: Path, is_there: Callable[[Bag], bool]) -> None:
    """Wait until the thread of a writer has written what a bag must have."""
    deadline, never = time.monotonic() + DEADLINE_S, threading.Event()
    while not is_there(Bag(directory)):
        assert time.monotonic() < deadline, 'the chunk is not on disk'
        never.wait(LOOK_S)
