"""
Packing of the rows of actuators and surroundings into serialised messages; done here only.

Every message of a run is encoded once, all in one block of memory. At each tick a kernel writes
the numbers of all rows into it. Recorder and publishers receive parts of the block.
"""

from collections.abc import Collection, Mapping, Sequence

from isa_ros.bag.message_chunk import Room
from isa_ros.bag.packed import Layout, layout, Packed
from isa_ros.core.bound import Bound
from isa_ros.core.record import floats
from isa_ros.core.signals import Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.topic import Topic
from isa_ros.run.link_packing import LinkWords
from isa_ros.run.pack_kernel import pack, PackedBlock, Packing
from isa_ros.run.quiet_recording import QuietRecording, record
from isa_ros.run.rare_messages import RareMessages
from isa_ros.run.row_messages import n_columns, Names, sources
from isa_ros.tick.exchange import PublishedRows
from msg_adapters import actuator_messages, clock, event
from msg_adapters.actuator_messages import SENT_SETPOINT, TEMPERATURE, topics
from msg_adapters.template import FIRST_VALUE, Template
import numpy as np
from numpy.typing import NDArray

Messages = Sequence[bytes | None]
"""Serialised messages of one source in the order of its topics; None: no message at this tick."""


class Packer:
    """
    Packs the messages of some rows.

    ``topics`` are all topics with messages, sorted by name: `TOPICS` of every actuator, the
    pressure of every supply, those of the body, and with ``is_run`` the clock, the events, and
    the diagnostics at every second and at the end. Temperatures have a message at t = 0 and at
    each tick that reaches a full second.
    """

    def __init__(
            self, names: Names, rows: PublishedRows, is_run: bool = True,
            start_ns: int = 0) -> None:
        self._names, self._rows = names, rows
        self._links = LinkWords(
            [row for row, (name, _) in enumerate(names.actuators) if name in names.linked],
            n_columns(rows), rows.sent, len(rows.samples))
        found = list(sources(names, rows, self._links, is_run))
        self.topics = tuple(sorted((topic for topic, _ in found), key=lambda topic: topic.name))
        if len({topic.name for topic in self.topics}) != len(self.topics):
            raise ValueError(f'a topic has two sources: {self.topics}')
        packed = [(topic, message) for topic, message in found if message is not None]
        self._place = {topic.name: k for k, (topic, _) in enumerate(packed)}
        self._index = {topic.name: k for k, topic in enumerate(self.topics)}
        self._template = Template([message for _, message in packed])
        self._bytes = self._template.block.view(np.uint8)
        self.rare = RareMessages(
            [name for name, _ in names.actuators], rows.samples,
            [name for name, _ in names.supplies], rows.supplies, is_run)
        """The messages that are encoded as they come."""
        self.start_ns = start_ns
        """Time of stamps at t = 0."""
        self._periods = {
            own.topic: own.period_ns for messages in names.bodies.values() for own in messages
            if own.period_ns} | {
            f'/{name}/{TEMPERATURE[0]}': NS_PER_SECOND for name in names.heated}
        self._not_due: frozenset[str] = frozenset()
        self._own = [[topic.name for topic in names.topics_of(row)]
                     for row in range(len(names.actuators))]
        self._layouts: dict[tuple[bytes, bytes, frozenset[str]], Layout] = {}
        self._recordings: list[Bound] = []
        self._bind()

    def _bind(self) -> None:
        """Bind the kernel to the rows as plain floats, and to the block."""
        rows, template = self._rows, self._template
        words = np.zeros(FIRST_VALUE + n_columns(rows) + self._links.n_words, np.uint64)
        bodies = tuple(floats(sample).reshape(-1) for sample in rows.bodies.values())
        self._packing = Packing(
            np.zeros(3, np.int64), floats(rows.samples), rows.applied, floats(rows.supplies),
            bodies or (np.zeros(0),), self._links.memory, words, words.view(np.float64),
            PackedBlock(template.block, template.places, template.sources))
        self._pack = Bound(pack, self._packing)
        self._kinds, self._sent_kinds = rows.applied['kinds'], self._links.sent['kinds']
        self._commands = {
            f'/{name}/{suffix}': kinds[row:row + 1]
            for suffix, kinds in ((_SETPOINT, self._kinds), (_SENT, self._sent_kinds))
            for row, (name, _) in enumerate(self._names.actuators)}

    def pack(
            self, t_ns: int, tick_start_ns: int, tuned: Mapping[int, Mapping[str, float]],
            tuned_supplies: Mapping[str, float] = {}) -> None:
        """
        Pack the rows of ``t_ns``, the end of a tick that began at ``tick_start_ns``.

        ``tuned`` are the parameters that changed at the tick's start, by row, and
        ``tuned_supplies`` those of the supplies.
        """
        self.pack_numbers(t_ns, tick_start_ns)
        if self._periods:
            self._not_due = frozenset(
                name for name, period in self._periods.items()
                if t_ns and t_ns // period == tick_start_ns // period)
        self.rare.pack(t_ns, tick_start_ns, tuned, tuned_supplies, self.start_ns)

    def pack_numbers(self, t_ns: int, tick_start_ns: int) -> None:
        """Pack the messages of numbers alone; the others stay those of the last `pack`."""
        self._packing.times[:] = t_ns, tick_start_ns, self.start_ns
        self._pack.run()

    def all_messages(self, events: Sequence[bytes] = ()) -> Packed:
        """Return all messages of the packed instant, in the order of `topics`."""
        where = self._layout_of(
            (self._kinds != 0).tobytes(), (self._sent_kinds != 0).tobytes(), self._not_due)
        packed = Packed(self._bytes, where)
        extra = [(self._index[topic], data) for topic, data in self.rare.items()]
        if events:
            extra += self.of_events(events)
        if not extra:
            return packed
        return Packed.of(sorted([*packed, *extra], key=lambda message: message[0]))

    def quiet_ticks(self, t_ns: int, step_ns: int) -> int:
        """Return how many ticks after ``t_ns`` have the layout of a quiet one."""
        ends = ((t_ns // period + 1) * period for period in self._rare_periods(step_ns).values())
        return min((-((t_ns - end) // step_ns) - 1 for end in ends), default=_MANY)

    def quiet_layout(self, step_ns: int, applied: bytes = b'') -> Layout:
        """Return the layout of a tick by who has a command, b'': nobody; without what is rare."""
        none = bytes(len(self._kinds))
        return self._layout_of(applied or none, none, frozenset(self._rare_periods(step_ns)))

    def _rare_periods(self, step_ns: int) -> dict[str, int]:
        return {name: period for name, period in self._periods.items() if period > step_ns}

    def recording(self, clock: NDArray[np.int64], layout: Layout, room: Room) -> Bound:
        """
        Return what packs and records quiet ticks into a room; ``clock`` as of a sink.

        Another call with the same clock, layout and buffer moves it to the new room.
        """
        self._packing.times[2] = self.start_ns
        own = next((own for own in self._recordings if own.memory.buffer is room.buffer
                    and own.memory.layout is layout and own.memory.clock is clock), None)
        if own is None:
            own = Bound(record, QuietRecording(
                clock, self._packing, self._bytes, layout, room.buffer, np.zeros(2, np.int64)))
            self._recordings = [*self._recordings[1 - _RECORDINGS:], own]
        own.memory.place[:] = room.at, room.tick_bytes
        return own

    def of_events(self, events: Sequence[bytes]) -> Packed:
        """Return messages of events alone."""
        return Packed.of([(self._index[event.TOPIC[0]], data) for data in events])

    def _layout_of(self, applied: bytes, sent: bytes, not_due: frozenset[str]) -> Layout:
        """Return the layout of a tick, by what each actuator has and what is not due."""
        key = applied, sent, not_due
        found = self._layouts.get(key)
        if found is None:
            found = self._layouts[key] = self._without(not_due.union(
                f'/{name}/{suffix}' for suffix, of_all in ((_SETPOINT, applied), (_SENT, sent))
                for (name, _), is_there in zip(self._names.actuators, of_all) if not is_there))
        return found

    def _without(self, absent: Collection[str]) -> Layout:
        """Return the layout of all topics but some."""
        present = [(self._index[name], place) for name, place in self._place.items()
                   if name not in absent]
        present.sort()
        places = [place for _, place in present]
        starts, sizes = self._template.starts, self._template.sizes
        return layout([index for index, _ in present], starts[places].tolist(),
                      sizes[places].tolist())

    def of_actuator(self, row: int, wanted: Collection[int] | None = None) -> list[bytes | None]:
        """
        Return the messages of one actuator in the order of `Names.topics_of`.

        ``wanted`` are the places of those that somebody reads; None: all. The others are None.
        """
        return self._messages(self._own[row], wanted)

    def topics_of(self, row: int) -> list[Topic]:
        """Return the topics of one actuator, in the order of its messages."""
        return [self.topics[self._index[name]] for name in self._own[row]]

    @property
    def applied(self) -> Records:
        """Return the rows of commands that took effect in the last tick, (n,)."""
        return self._rows.applied

    def has_applied(self, row: int) -> bool:
        """Return whether a command of an actuator took effect in the last tick, or was sent."""
        return bool(self._kinds[row] or self._sent_kinds[row])

    def of(
            self, topics: Sequence[Topic],
            wanted: Collection[int] | None = None) -> list[bytes | None]:
        """Return the messages of some topics; None: none at this instant, or not wanted."""
        return self._messages([topic.name for topic in topics], wanted)

    def _messages(
            self, names: Sequence[str], wanted: Collection[int] | None) -> list[bytes | None]:
        messages: list[bytes | None] = [None] * len(names)
        for slot in range(len(names)) if wanted is None else wanted:
            messages[slot] = self._message(names[slot])
        return messages

    def _message(self, name: str) -> bytes | None:
        """Return the message of a topic at the packed instant; None: it has none."""
        place = self._place.get(name)
        if place is None:
            return self.rare.get(name)
        kinds = self._commands.get(name)
        if name in self._not_due or (kinds is not None and not kinds[0]):
            return None
        return self._template.message(place)

    @property
    def surroundings(self) -> list[Topic]:
        """Return the topics of supplies and body, and the diagnostics."""
        own = {f'/{name}/{suffix}' for name, _ in self._names.actuators
               for suffix, _ in topics(is_heated=True, has_link=True, is_cushioned=True)}
        return [topic for topic in self.topics
                if topic.name not in own and topic.name not in (clock.TOPIC[0], event.TOPIC[0])]


_MANY = 1_000_000     # ticks
_RECORDINGS = 4     # that are kept: the buffers of a bag in turn, and few layouts
_SETPOINT = actuator_messages.APPLIED_SETPOINT[0]
_SENT = SENT_SETPOINT[0]
