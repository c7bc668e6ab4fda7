"""
Serve the actuators of a run, or toys, on a bus until the standard input ends.

The ticks are those of a run in frame pace. At the end it prints the number of ticks since the
first wanted one, and the sha256 of their samples.
"""

import argparse
from collections.abc import Callable, Sequence
import hashlib
import json
from pathlib import Path
import select
import sys

import isa_ros
from isa_ros.core.signals import COMMAND
from isa_ros.fieldbus.canopen.line import canopen_line
from isa_ros.fieldbus.canopen.mit_line import mit_line
from isa_ros.fieldbus.description.eds import eds_text
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.line import Line
import numpy as np
from tests.fieldbus.canopen.toy import ToyDrive

LINES = {'canopen': canopen_line, 'mit': mit_line}
STEP_NS = 1_000_000
Tick = Callable[[], bytes]
"""Simulates a tick of all actuators and returns their samples."""


def toys(names: Sequence[str], fault_at: int | None) -> tuple[list[BusDevice], int, Tick]:
    """Return toys, their tick, and what simulates it."""
    drives = [ToyDrive(name, fault_at) for name in names]

    def tick() -> bytes:
        for drive in drives:
            drive.tick()
        return b''.join(drive.transmit(0x1A00) + drive.transmit(0x1A01) for drive in drives)
    return list(drives), STEP_NS, tick


def actuators(config: str) -> tuple[list[BusDevice], int, Tick]:
    """Return the devices of a configuration, their tick, and what simulates it."""
    isa_ros.load(config).simulation().step()     # kernels are loaded before the bus opens
    simulation = isa_ros.load(config).simulation()
    run = simulation.scenario.run
    devices = devices_of(run)
    commands = np.zeros(len(devices), COMMAND)

    def take() -> bytes:
        for row, device in enumerate(devices):
            device.take_sample(simulation.group.samples[row], simulation.ticks)
        return bytes(simulation.group.samples.tobytes())

    def tick() -> bytes:
        for row, device in enumerate(devices):
            simulation.tune(simulation.names[row], device.changes())
            device.fill_command(commands[row])
        simulation.step(commands)
        return take()
    take()
    return devices, run.step_ns, tick


def serve(line: Line, devices: Sequence[BusDevice], tick: Tick) -> dict[str, object]:
    """Serve until the standard input ends; return ticks and digest."""
    digest, ticks = hashlib.sha256(), 0
    line.update()
    while not select.select([sys.stdin], [], [], 0.0)[0]:
        if not line.serve(0.05):
            continue
        if any(device.is_wanted for device in devices):
            digest.update(tick())
            ticks += 1
        line.update()
    return {'ticks': ticks, 'sha256': digest.hexdigest()}


def main() -> None:
    """Open the line and serve it."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--line', choices=LINES, default='canopen')
    parser.add_argument('--interface', required=True)
    parser.add_argument('--channel', required=True)
    parser.add_argument('--config')
    parser.add_argument('--toys', nargs='*', default=[])
    parser.add_argument('--fault-at', type=int)
    parser.add_argument('--eds', type=Path)
    options = parser.parse_args()
    devices, step_ns, tick = (
        actuators(options.config) if options.config else toys(options.toys, options.fault_at))
    if options.eds:
        options.eds.write_text(eds_text(devices[0]))
    line = LINES[options.line](devices, options.interface, options.channel, step_ns)
    print('ready', flush=True)
    try:
        print(json.dumps(serve(line, devices, tick)), flush=True)
    finally:
        line.close()


if __name__ == '__main__':
    main()
