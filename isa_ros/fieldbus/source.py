"""
The master of a bus as the source of a run's commands, in frame pace: a cycle is a tick.

Before tick k the devices have the sample of t_k; the line is then served until a cycle begins, and
what the master has sent by then are the commands of tick k. Connections that a fault breaks from
tick k on are broken before. Simulated time begins with the first control word that is not 0;
cycles before it are served without ticks, so that a bag does not depend on how long a master needs
to come up. Host time is not read.
"""

from collections.abc import Callable, Mapping, Sequence
import time
from typing import cast

from isa_ros.core.signals import Records
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.line import Line, PortLine
from isa_ros.run.pacing import SLICE_S
from isa_ros.scenario.faults import ParameterChanges

Faults = Callable[[int], ParameterChanges | None]
"""Returns the parameters that faults change at a tick; None: none."""


class FrameSource:
    """
    A `Source` whose ticks are the cycles of a line.

    ``devices`` are in the order of the actuators' rows; ``ready`` is called when the line begins
    to be served.
    """

    def __init__(
            self, line: Line, devices: Sequence[BusDevice], faults: Faults,
            ready: Callable[[], object] = lambda: None) -> None:
        self._line, self._devices, self._faults = line, devices, faults
        self._ready = ready
        self._shown: int | None = None
        self._plugged, self._unplugged = -1, set[tuple[str, str]]()
        self._events: list[str] = []
        self.has_begun = False
        """Whether simulated time has begun."""

    def quiet_until(self, tick: int) -> float:
        """Return the tick itself: frames may bring commands for any."""
        return tick

    def is_due(self, tick: int, samples: Records) -> bool:
        """Serve the line for at most `SLICE_S`; return whether the cycle of the tick began."""
        self.show(tick, samples)
        end = time.monotonic() + SLICE_S
        left = SLICE_S
        while left > 0.0:
            if self._line.serve(left):
                if self.begins():
                    return True
                self._line.update()     # the master sees the same sample again
            left = end - time.monotonic()
        return False

    def show(self, tick: int, samples: Records) -> None:
        """Give the devices the samples of a tick, once."""
        if tick == self._shown:
            return
        if self._shown is None:
            self._ready()
        self._shown = tick
        self._plug(tick)
        for device, sample in zip(self._devices, samples):
            device.take_sample(sample, tick)
        self._line.update()

    def take_tuned(self, tuned: Mapping[int, Mapping[str, float]]) -> None:
        """Let the objects of the devices show gains and limits, whoever changed them."""
        for row, values in tuned.items():
            self._devices[row].take_changes(values)

    def end(self, tick: int, samples: Records) -> Sequence[str]:
        """Let the master have the last samples where the line sends them by itself."""
        self.show(tick, samples)
        return ()

    def begins(self) -> bool:
        """Return whether simulated time runs, now that a cycle has begun."""
        if not self.has_begun:
            self.has_begun = any(device.is_wanted for device in self._devices)
        return self.has_begun

    def commands(self, tick: int, out: Records) -> None:
        """Write what the master commands."""
        for device, command in zip(self._devices, out):
            device.fill_command(command)

    def events(self, tick: int) -> Sequence[str]:
        """Return the faults of connections since the last tick."""
        events, self._events = self._events, []
        return events

    def _plug(self, until: int) -> None:
        """Begin and end faults of connections up to a tick; a run that is reset begins anew."""
        if until < self._plugged:
            for device, fault in [*self._unplugged]:
                self._set_port(device, fault, False)
            self._plugged = -1
        for tick in range(self._plugged + 1, until + 1):
            faults = self._faults(tick)
            for device, values in ({} if faults is None else faults.ports).items():
                for fault, value in values.items():
                    self._set_port(device, fault, value != 0.0)
                    self._events.append(
                        f'bus: {device} {fault} {"begins" if value else "ends"}')
        self._plugged = until

    def _set_port(self, device: str, fault: str, is_on: bool) -> None:
        (self._unplugged.add if is_on else self._unplugged.discard)((device, fault))
        cast(PortLine, self._line).set_port(device, fault, is_on)

    def changes(self, tick: int) -> ParameterChanges | None:
        """Return the faults of the tick, and what the master has written over SDO."""
        faults = self._faults(tick)
        written = {row: values for row, device in enumerate(self._devices)
                   if (values := device.changes())}
        if faults is None or not written:
            return ParameterChanges(written, {}) if written else faults
        return faults._replace(actuators={
            row: {**faults.actuators.get(row, {}), **written.get(row, {})}
            for row in sorted({*faults.actuators, *written})})
