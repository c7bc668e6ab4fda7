"""The messages of the rows of actuators and surroundings: topics, and where their values are."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import NamedTuple

from isa_ros.core.record import float_columns, floats
from isa_ros.core.signals import SAMPLE
from isa_ros.core.topic import KEPT, Qos, Topic
from isa_ros.run.body_messages import prepared, type_of
from isa_ros.run.link_packing import LinkWords
from isa_ros.run.pack_kernel import APPLIED, PRESSURES
from isa_ros.run.supply_messages import of_supply, SIGNALS
from isa_ros.surroundings.messages import BodyMessage
from isa_ros.tick.exchange import PublishedRows
from msg_adapters import actuator_messages, clock, coordinator_messages, diagnostics, event
from msg_adapters.actuator_messages import CUSHION_PRESSURE, KEPT_TOPICS, TEMPERATURE, topics
from msg_adapters.sensor_messages import fluid_pressure, temperature
from msg_adapters.template import Prepared

_SAMPLE = tuple(SAMPLE.names or ())
_COLUMNS = len(_SAMPLE) + len(PRESSURES) + len(APPLIED)
"""Of an actuator."""

Source = tuple[Topic, Prepared | None]
"""A topic and its message over columns of the rows; None: it is encoded as it comes."""


class Names(NamedTuple):
    """Names of the sources of the rows, as used in topics and frames."""

    actuators: Sequence[tuple[str, bool]]
    """(name, is_rotary) of each."""
    supplies: Sequence[tuple[str, Sequence[str]]] = ()
    """(name, signals that it publishes) of each row."""
    bodies: Mapping[str, Sequence[BodyMessage]] = {}
    """What is published of each body's sample."""
    heated: Collection[str] = ()
    """Names of the actuators whose temperature is published."""
    linked: Collection[str] = ()
    """Names of the actuators with a link."""
    cushioned: Collection[str] = ()
    """Names of the actuators with cushioned ends."""

    def topics_of(self, row: int) -> list[Topic]:
        """Return the topics of an actuator."""
        name = self.actuators[row][0]
        return topics_of_actuator(
            f'/{name}', name in self.heated, name in self.linked, name in self.cushioned)


def topics_of_actuator(
        prefix: str, is_heated: bool, has_link: bool = False,
        is_cushioned: bool = False) -> list[Topic]:
    """Return the topics of an actuator below ``prefix`` with their qualities of service."""
    return [Topic(f'{prefix}/{suffix}', type_, KEPT if (suffix, type_) in KEPT_TOPICS else Qos())
            for suffix, type_ in topics(is_heated, has_link, is_cushioned)]


def sources(
        names: Names, rows: PublishedRows, links: LinkWords, is_run: bool) -> Iterator[Source]:
    """
    Yield all topics with their messages: of actuators, supplies and bodies, in the order of rows.

    ``is_run`` adds the clock, the events and the diagnostics. Columns are those of `n_columns`,
    followed by the words of the links.
    """
    at = 0
    for row, (name, is_rotary) in enumerate(names.actuators):
        own = links.messages(row, name, _of_actuator(name, is_rotary, at))
        at += _COLUMNS
        for topic in names.topics_of(row):
            yield topic, own.get(topic.name.rpartition('/')[2])
    for supply, published in names.supplies:
        for signal in published:
            yield of_supply(supply, signal, at)
        at += len(SIGNALS)
    if names.supplies:
        yield Topic(*coordinator_messages.APPLIED_PARAMETERS, KEPT), None
    for body, sample in rows.bodies.items():
        columns = float_columns(sample.dtype, at)
        at += floats(sample).size
        for message in names.bodies.get(body, ()):
            yield Topic(message.topic, type_of(message)), prepared(message, columns)
    if is_run:
        yield Topic(*clock.TOPIC), clock.clock()
        yield Topic(*event.TOPIC), None
        yield Topic(*diagnostics.TOPIC), None


def _of_actuator(name: str, is_rotary: bool, first: int) -> dict[str, Prepared]:
    places = {field: first + k for k, field in enumerate(
        (*_SAMPLE, *(f'{field}, absolute' for field in PRESSURES),
         *(f'applied {field}' for field in APPLIED)))}
    absolute = {field: places[f'{field}, absolute'] for field in PRESSURES}
    messages = actuator_messages.prepared(
        name, is_rotary, places, absolute,
        {field: places[f'applied {field}'] for field in APPLIED})
    return {**messages,
            CUSHION_PRESSURE[0]: fluid_pressure(name, absolute['cushion_pressure']),
            TEMPERATURE[0]: temperature(name, places['temperature'])}


def n_columns(rows: PublishedRows) -> int:
    """Return the number of values of all rows, without the words of links."""
    bodies = sum(floats(sample).size for sample in rows.bodies.values())
    return len(rows.samples) * _COLUMNS + len(rows.supplies) * len(SIGNALS) + bodies
