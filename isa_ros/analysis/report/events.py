"""
What the devices of a run did, from the messages ``~/device`` of its bag.

One is recorded when a state, a mode, a warning or a trip changes, so that two in a row show what
is new; behind a link they are what has arrived.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.errors import BagError
from isa_ros.text.table import aligned, Cells
from msg_adapters import device
from msg_adapters.actuator_messages import DEVICE
from msg_adapters.cdr import CdrError

TRIP, WARNING, STATE = 'trip', 'warning', 'state'
HEADER = ('t, s', 'actuator', '', 'what')
MOST = 200      # rows of a table


class DeviceEvent(NamedTuple):
    """A change of a device."""

    t_s: float
    """When it changed, by the device's own time."""
    actuator: str
    kind: str
    """`TRIP`, `WARNING` or `STATE`."""
    what: str
    """The condition; or the new state, and the reason."""


def recorded_events(bag: Bag) -> list[DeviceEvent]:
    """
    Return the changes of all devices of a bag but that at t = 0, in the order of their messages.

    Raises
    ------
    BagError
        A message is not the status of a device.

    """
    run = RunConfig.from_yaml(bag.provenance.configuration)
    topics = {f'/{own.name}/{DEVICE[0]}': own.name for own in run.actuators}
    before: dict[str, Mapping[str, str]] = {}
    found: list[DeviceEvent] = []
    for message in bag.messages():
        name = topics.get(message.topic)
        if name is None:
            continue
        try:
            now = device.values(message.data)
            found += _changes(name, before.get(name), now)
        except (CdrError, KeyError, ValueError) as error:
            raise BagError(f'{bag.place_of(message)}: {error}') from error
        before[name] = now
    return found


def trips(events: list[DeviceEvent]) -> list[DeviceEvent]:
    """Return the events that are trips."""
    return [event for event in events if event.kind == TRIP]


def _changes(
        name: str, before: Mapping[str, str] | None, now: Mapping[str, str]
        ) -> Iterator[DeviceEvent]:
    if before is None:
        return
    t_s = float(now['since_s'])
    for kind, key in ((TRIP, 'faults'), (WARNING, 'warnings')):
        old = _names(before[key])
        for condition in _names(now[key]):
            if condition not in old:
                yield DeviceEvent(t_s, name, kind, condition)
    if now['state'] != before['state']:
        yield DeviceEvent(t_s, name, STATE, f'{now["state"]}: {now["reason"]}')


def _names(text: str) -> list[str]:
    return text.split(', ') if text else []


def event_rows(events: list[DeviceEvent]) -> list[Cells]:
    """Return the rows of a table with its header; of very many events the first ones."""
    rows: list[Cells] = [HEADER, *((f'{own.t_s:.6f}', own.actuator, own.kind, own.what)
                                   for own in events[:MOST])]
    if len(events) > MOST:
        rows.append(('', '', '', f'and {len(events) - MOST} more'))
    return rows


def events_text(bag: Bag) -> str:
    """Return the events of a bag as a table of text; '' if there are none."""
    events = recorded_events(bag)
    return '\n'.join(aligned(event_rows(events))) if events else ''
