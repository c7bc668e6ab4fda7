"""
A device of the package and a real actuator in memory, driven by a master of its own.

The master knows CiA 301 only: it learns what its process data hold from the mapping objects.
"""

from collections.abc import Iterable
import struct

import isa_ros
from isa_ros.core.signals import COMMAND
from isa_ros.fieldbus.device.devices import devices_of
import numpy as np

FORMATS = {'BOOLEAN': '?', 'INTEGER8': 'b', 'INTEGER16': 'h', 'INTEGER32': 'i', 'UNSIGNED8': 'B',
           'UNSIGNED16': 'H', 'UNSIGNED32': 'I', 'REAL32': 'f'}
CONTROL, STATUS = 0x6040, 0x6041


class Rig:
    """One actuator of a run behind its device, advanced tick by tick."""

    def __init__(self, config='rig_linear', profile='cia402', changes=None, row=0):
        run = isa_ros.load(config)
        if changes:
            run = run.replace(changes)
        self.simulation = run.simulation()
        self.names = self.simulation.names
        self.device = devices_of(self.simulation.scenario.run, profile)[row]
        self.commands = np.zeros(len(self.names), COMMAND)
        self.row = row
        self.emergencies = []
        self.device.take_sample(self.sample, 0)

    @property
    def sample(self):
        return self.simulation.group.samples[self.row]

    def tick(self):
        """Advance by a tick, as a run on a bus does."""
        self.simulation.tune(self.names[self.row], self.device.changes())
        self.device.fill_command(self.commands[self.row])
        self.simulation.step(self.commands)
        if values := self.simulation.tuned.get(self.row):
            self.device.take_changes(values)
        self.device.take_sample(self.sample, self.simulation.ticks)
        self.emergencies += self.device.emergencies()


class Master:
    """Exchanges process data with a device at every tick."""

    def __init__(self, rig, pdos=(0x1610, 0x1A10)):
        self.rig, self.device = rig, rig.device
        self.receive, self.transmit = pdos
        self.outputs = dict.fromkeys(self.mapped(self.receive), 0)
        for key in self.outputs:
            if self.device.table.entry(*key).data_type.name == 'REAL32':
                self.outputs[key] = float('nan')
        self.inputs = {}
        self._layouts = {pdo: (self.layout(pdo), self.mapped(pdo)) for pdo in pdos}
        self.device.begin_operation()

    def upload(self, index, subindex=0):
        """Read an entry by its declared type."""
        data = self.device.read(index, subindex)
        name = self.device.table.entry(index, subindex).data_type.name
        return data.decode() if name == 'VISIBLE_STRING' else struct.unpack(
            f'<{FORMATS[name]}', data)[0]

    def download(self, index, subindex, value, *, is_preoperational=False):
        """Write an entry by its declared type."""
        name = self.device.table.entry(index, subindex).data_type.name
        self.device.write(index, subindex, struct.pack(f'<{FORMATS[name]}', value),
                          is_preoperational=is_preoperational)

    def mapped(self, pdo) -> Iterable[tuple[int, int]]:
        """Return the keys in a PDO, without gaps."""
        words = [self.upload(pdo, k + 1) for k in range(self.upload(pdo))]
        return [(word >> 16, word >> 8 & 0xFF) for word in words if word >> 16]

    def layout(self, pdo):
        """Return the format of a PDO."""
        text = '<'
        for k in range(self.upload(pdo)):
            word = self.upload(pdo, k + 1)
            key = word >> 16, word >> 8 & 0xFF
            text += (FORMATS[self.device.table.entry(*key).data_type.name] if word >> 16
                     else f'{(word & 0xFF) // 8}x')
        return struct.Struct(text)

    def cycle(self, control=None, **targets):
        """Send process data, let a tick pass, and return the status word."""
        if control is not None:
            self.outputs[CONTROL, 0] = control
        for index, value in targets.items():
            self.outputs[int(index[1:], 16), 0] = value
        layout, _ = self._layouts[self.receive]
        self.device.receive(self.receive, layout.pack(*self.outputs.values()))
        self.rig.tick()
        layout, keys = self._layouts[self.transmit]
        values = layout.unpack(self.device.transmit(self.transmit))
        self.inputs = dict(zip(keys, values, strict=True))
        return self.inputs[STATUS, 0]

    def cycle_until(self, is_reached, control=None, most=1000):
        """Let ticks pass until the status word is as wanted."""
        for _ in range(most):
            word = self.cycle(control)
            if is_reached(word):
                return word
        raise AssertionError(f'status word {word:#06x} after {most} ticks')


def without_supply(rig, is_low):
    """Let the supply fail or come back."""
    rig.simulation.tune('supply', {'pressure_mpa': 1.0 if is_low else 20.7})
