"""A line whose master is a list, and devices with a control word and a position only."""

from collections.abc import Callable, Iterable, Mapping, Sequence
import struct

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.signals import HAS_ENABLE, HAS_SETPOINT
from isa_ros.fieldbus.device.bus_device import BusDevice
import numpy as np

OUTPUT = struct.Struct('<Hi')     # control word; position, um | urad
RECEIVE = 0x1600
ENABLE = 0x000F
SILENCE = None
"""An entry of a master that sends nothing for as long as the line waits."""


class ToyDevice(BusDevice):
    """Holds the position at which it was switched on, and moves by what the master sends."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.is_wanted = False
        self.samples: list[tuple[int, float]] = []
        self.written: dict[str, float] = {}
        self.shown: dict[str, float] = {}
        self.output = (0, 0)

    def receive(self, pdo: int, data: bytes) -> None:
        self.output = OUTPUT.unpack(data)
        self.is_wanted |= self.output[0] != 0

    def take_sample(self, sample: np.void, tick: int) -> None:
        self.samples.append((tick, float(sample['position'])))

    def fill_command(self, command: np.void) -> None:
        control_word, micrometres = self.output
        command['kinds'] = HAS_ENABLE | HAS_SETPOINT
        command['is_enabled'] = control_word == ENABLE
        command['position'] = self.samples[0][1] + 1e-6 * micrometres
        command['stiffness'] = command['damping'] = np.nan

    def changes(self) -> dict[str, float]:
        written, self.written = self.written, {}
        return written

    def take_changes(self, values: Mapping[str, float]) -> None:
        self.shown |= values


Cycle = tuple[int, int] | None


class ToyLine:
    """Serves a master that sends ``cycles`` to every device; later it is silent."""

    def __init__(
            self, devices: Sequence[BusDevice], cycles: Iterable[Cycle],
            sleep: Callable[[float], None] = lambda seconds: None) -> None:
        self.devices, self.sleep = devices, sleep
        self.cycles = iter(cycles)
        self.log: list[str] = []
        self.ports: list[tuple[str, str, bool]] = []

    def serve(self, timeout: float) -> bool:
        cycle = next(self.cycles, SILENCE)
        if cycle is SILENCE:
            self.sleep(timeout)
            return False
        self.log.append(f'cycle {cycle[0]}')
        for device in self.devices:
            device.receive(RECEIVE, OUTPUT.pack(*cycle))
        return True

    def set_port(self, device: str, fault: str, is_on: bool) -> None:
        self.log.append(f'{device} {fault} {is_on}')
        self.ports.append((device, fault, is_on))

    def update(self) -> None:
        self.log.append('update')

    def miss(self) -> None:
        self.log.append('miss')

    def close(self) -> None:
        self.log.append('close')


def toys_of(run: RunConfig, profile: str = 'cia402') -> list[ToyDevice]:
    """Return a toy for each actuator of a run."""
    return [ToyDevice(actuator.name) for actuator in run.actuators]
