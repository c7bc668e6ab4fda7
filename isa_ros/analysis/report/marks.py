"""Marks on the time axis: states of the devices as bands, events as lines."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.device import state_name
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.run.events import Event, History, STATE

MOST = 500      # marks of a group


class Band(NamedTuple):
    """A state of a device, from its begin to the next one."""

    source: str
    begin_s: float
    end_s: float
    state: str


class Marks(NamedTuple):
    """What is marked in the panels of a group."""

    bands: Sequence[Band]
    events: Sequence[Event]


def bands_of(run: RunConfig, history: History, end_s: float) -> list[Band]:
    """Return the states of all devices in the order of time, of each device one by one."""
    found: list[Band] = []
    for row, actuator in enumerate(run.actuators):
        own: list[Band] = []
        for tick, sample in zip(history.ticks, history.samples[:, row]):
            state = state_name(sample['device_state'])
            if own and own[-1].state == state:
                continue
            begin = float(sample['state_since']) if own else tick * run.step_ns / NS_PER_SECOND
            if own:
                own[-1] = own[-1]._replace(end_s=begin)
            own.append(Band(actuator.name, begin, end_s, state))
        found += own
    return found


def marks_of(sources: Sequence[str], bands: Sequence[Band], events: Sequence[Event]) -> Marks:
    """Return the marks of a group, whose actuators and supplies are ``sources``."""
    return Marks([band for band in bands if band.source in sources],
                 [event for event in events
                  if event.source in sources and event.kind != STATE][:MOST])
