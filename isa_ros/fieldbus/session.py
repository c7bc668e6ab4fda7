"""Sessions whose commands come from the master of a bus."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.line import Line
from isa_ros.fieldbus.real_time import RealTimeSource, scheduled_first, ServedPace
from isa_ros.fieldbus.request import BUSES, BusRequest, REAL_TIME
from isa_ros.fieldbus.source import FrameSource
from isa_ros.run.session import prepare, Session
from isa_ros.scenario.faults import BUS
from isa_ros.scenario.scenario import Scenario
from isa_ros.tick.source import Source

OpenLine = Callable[[Sequence[BusDevice], int], Line]
"""Opens a line with the devices of a run, whose tick has a length in ns."""

PrintLine = Callable[[str], object]
"""Prints a line for the user."""


@frozen
class BusRun:
    """A session on a bus; ``pace`` is that of real-time pace, None in frame pace."""

    session: Session
    pace: ServedPace | None

    @property
    def summary(self) -> str | None:
        """Return a line for the end of the run."""
        return None if self.pace is None else str(self.pace.times)


def commanded_by_bus(run: RunConfig) -> RunConfig:
    """
    Return a run whose actuators wait for a master to enable them.

    Raises
    ------
    ConfigError
        An actuator has a modelled link, or the run has controllers.

    """
    if run.linked:
        raise ConfigError(
            f'{run.source}: link of {", ".join(run.linked)}: must be none under isa bus, whose '
            'bus is the link')
    if names := [*run.controllers, *(own.name for own in run.called)]:
        raise ConfigError(
            f'{run.source}: controllers = {", ".join(names)}: not used under isa bus, '
            'whose master commands the actuators')
    return replace(run, actuators=tuple(
        replace(actuator, auto_enable=False) for actuator in run.actuators))


def refuse_tracks(scenario: Scenario) -> None:
    """
    Refuse a scenario that commands actuators; its faults, loads and start are welcome.

    Raises
    ------
    ConfigError
        It has tracks.

    """
    if scenario.tracks:
        names = ', '.join(track.actuator for track in scenario.tracks)
        raise ConfigError(
            f'scenario {scenario.name}: tracks of {names}: not used under isa bus, whose master '
            'commands the actuators; its faults, loads and start are')


def refuse_ports(scenario: Scenario, bus: str) -> None:
    """
    Refuse faults of connections that a bus, one of `BUSES`, does not have.

    Raises
    ------
    ConfigError
        The scenario has one.

    """
    known = BUSES[bus].port_faults
    for fault in scenario.faults:
        for name in fault.values if fault.of == BUS else ():
            if name not in known:
                raise ConfigError(
                    f'scenario {scenario.name}: fault {name} of bus: {fault.target} is not one '
                    f'of isa bus {bus}, which has {", ".join(known) or "none"}')


def prepare_bus(
        request: BusRequest, devices_of: Callable[[RunConfig, str], Sequence[BusDevice]],
        open_line: OpenLine, print_line: PrintLine) -> BusRun:
    """
    Return a checked session whose commands come from the master on a line.

    The line is opened when the kernels are compiled and the nodes are ready. ``print_line`` prints
    what happens on the bus.

    Raises
    ------
    ConfigError
        As `isa_ros.run.session.prepare`, or the run cannot be used on a bus.

    """
    is_real_time = request.pace == REAL_TIME
    if is_real_time and request.run.real_time_factor:
        raise ConfigError(
            f'--real-time-factor {request.run.real_time_factor:g} is not used with '
            f'--pace {REAL_TIME}; leave one out')
    session = prepare(request.run, commanded_by_bus, has_bus=True)
    refuse_tracks(session.scenario)
    refuse_ports(session.scenario, request.bus)
    run = session.run
    pace = ServedPace(run.step_ns, warn=print_line) if is_real_time else None

    @contextmanager
    def opened() -> Iterator[Source]:
        devices = devices_of(run, request.profile)
        line = open_line(devices, run.step_ns)
        try:
            names = ', '.join(device.name for device in devices)
            source = FrameSource(
                line, devices, session.scenario.changes.get,
                lambda: print_line(f'{names} wait for a master on {request.place}'))
            if pace is None:
                yield source
            else:
                with scheduled_first(print_line):
                    yield RealTimeSource(source, line, pace, 1e-3 * request.watchdog_ms)
        finally:
            line.close()
    return BusRun(
        replace(session, source=opened, pace=session.pace if pace is None else pace), pace)
