"""One actuator of a run as a `BusDevice`: dictionary, process data, and a drive of a profile."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager

from isa_ros.actuator.tunable import with_changed
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.abort import (
    NOT_TRANSFERABLE, OUT_OF_RANGE, READ_ONLY, SdoAbort)
from isa_ros.fieldbus.device.axis import Axis, FIELDS
from isa_ros.fieldbus.device.bus_device import Emergency, Identity
from isa_ros.fieldbus.device.communication_area import ERROR_FIELD, LOAD, RESTORE, STORE
from isa_ros.fieldbus.device.diagnosis import (
    ACKNOWLEDGED, delete_messages, note_message, refuse_acknowledgement, take_acknowledgement)
from isa_ros.fieldbus.device.dictionary import Key, ObjectDictionary, refuse_beyond
from isa_ros.fieldbus.device.drive import Drive
from isa_ros.fieldbus.device.faults import delete_errors, Faults, PDO_LENGTH
from isa_ros.fieldbus.device.integer_twins import take_twins, twin_actuals, TWINS
from isa_ros.fieldbus.device.manufacturer_area import note_refusal, tunable_keys
from isa_ros.fieldbus.device.objects import ObjectEntry, ObjectTable, Value
from isa_ros.fieldbus.device.process_data import is_changed_in_preop, ProcessData
from isa_ros.tick.emergency_stop import LINE
import numpy as np

_ERROR_REGISTER, _ERROR_CODE, _CONTROL = (0x1001, 0), (0x603F, 0), (0x6040, 0)


class ActuatorDevice:
    """
    A `BusDevice`.

    ``drive_of`` makes the drive of a profile from axis, dictionary values and faults.
    """

    def __init__(
            self, axis: Axis, identity: Identity, table: ObjectTable,
            drive_of: Callable[[Axis, dict[Key, Value], Faults], Drive]) -> None:
        self.name, self.identity, self.table = axis.name, identity, table
        self.is_wanted = False
        self._axis = axis
        self._actuals: dict[Key, Callable[[], Value]] = {}
        self._dictionary = ObjectDictionary(table, self._actuals, self._admit)
        values = self._values = self._dictionary.values
        self._t_ns = 0
        self._faults = Faults(axis.sheet.reu.protection, values, lambda error: note_message(
            values, error, self._t_ns))
        self._process_data = ProcessData(table, values)
        self._tunables = tunable_keys(axis)
        self._changes: dict[str, float] = {}
        self._drive = drive_of(axis, values, self._faults)
        self._twins = {key: table.entry(*key) for key in TWINS}
        self._actuals |= {
            _ERROR_REGISTER: lambda: self._faults.register,
            _ERROR_CODE: lambda: self._faults.code,
            **{(one.index, one.subindex): _measured(axis, one)
               for one in table.entries if one.source},
            **twin_actuals(values, self._twins), **self._drive.actuals}

    # Objects.

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry; raises `SdoAbort`."""
        with self._noting(index, subindex):
            return self._dictionary.read(index, subindex)

    def write(
            self, index: int, subindex: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write an entry; raises `SdoAbort`."""
        with self._noting(index, subindex):
            if is_changed_in_preop(index):
                value = self._dictionary.admitted(self.table.entry(index, subindex), data)
                self._process_data.write(index, subindex, int(value), is_preoperational)
                return
            if index in (STORE, RESTORE):
                self._restore(index, subindex, data)
                return
            self._dictionary.write(index, subindex, data)
        self._written([(index, subindex)])

    def read_all(self, index: int) -> bytes:
        """Return all entries of an object; raises `SdoAbort`."""
        with self._noting(index):
            if is_changed_in_preop(index) and index in self.table:
                return self._process_data.read_all(index)
            return self._dictionary.read_all(index)

    def write_all(self, index: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write all entries of an object; raises `SdoAbort`."""
        with self._noting(index):
            if is_changed_in_preop(index) and index in self.table:
                self._process_data.write_all(index, data, is_preoperational)
                return
            self._dictionary.write_all(index, data)
        self._written([(index, entry.subindex) for entry in self.table.at(index).entries])

    def store(self, index: int, subindex: int, value: Value) -> None:
        """Set an entry on behalf of the bus itself, without checks."""
        self._values[index, subindex] = value

    def _restore(self, index: int, subindex: int, data: bytes) -> None:
        """Accept the signature of 0x1011, and refuse to store; nothing changes."""
        entry = self.table.entry(index, subindex)
        if not entry.is_writable:
            raise SdoAbort(READ_ONLY)
        word = entry.data_type.unpack(data)
        if index == STORE or word != LOAD:
            raise SdoAbort(NOT_TRANSFERABLE)

    @contextmanager
    def _noting(self, index: int, subindex: int | None = None) -> Iterator[None]:
        """Keep the reason of a refusal as a text."""
        try:
            yield
        except SdoAbort as refused:
            place = f'0x{index:04X}' + ('' if subindex is None else f':{subindex}')
            note_refusal(self._values, refused.reason or f'{place}: {refused.meaning}')
            raise

    def _admit(self, entry: ObjectEntry, value: Value) -> None:
        """Refuse a value by the rules of the REU or the drive."""
        if (entry.index, entry.subindex) == ACKNOWLEDGED:
            refuse_acknowledgement(self._values, int(value))
        own = self._tunables.get((entry.index, entry.subindex))
        if own is None:
            self._drive.admit(entry, value)
            return
        changed = {one.name: float(self._values[key]) for key, one in self._tunables.items()
                   if self._values[key] != one.value}
        try:
            with_changed(self._axis.sheet, changed | {own.name: float(value)})
        except ConfigError as error:
            raise SdoAbort(OUT_OF_RANGE, str(error)) from error

    def _written(self, keys: list[Key]) -> None:
        for key in keys:
            if key in self._tunables:
                self._changes[self._tunables[key].name] = float(self._values[key])
            elif key == (ERROR_FIELD, 0):
                delete_errors(self._values)
            elif key == ACKNOWLEDGED:
                take_acknowledgement(self._values)
        self._take_received(keys)

    # Process data.

    def assigned(self, assignment: int) -> list[int]:
        """Return the PDOs of EtherCAT's assignment."""
        return self._process_data.assigned(assignment)

    def size(self, pdo: int) -> int:
        """Return the bytes of a PDO; raises `SdoAbort` for one that does not exist."""
        return self._process_data.layout(pdo).packing.size

    def receive(self, pdo: int, data: bytes) -> None:
        """
        Take process data; those that are too short are reported and not used.

        An integer beyond its range is not taken: the value that there was stays.
        """
        layout = self._process_data.layout(pdo)
        if len(data) < layout.packing.size:
            self._faults.note(PDO_LENGTH)
            note_refusal(self._values, f'0x{pdo:04X}: {len(data)} bytes of process data, must be '
                         f'>= {layout.packing.size}')
            return
        found = dict(zip(layout.keys, layout.packing.unpack_from(data)))
        for entry in layout.bounded:
            try:
                refuse_beyond(entry, found[entry.index, entry.subindex])
            except SdoAbort as refused:
                note_refusal(self._values, refused.reason)
                del found[entry.index, entry.subindex]
        self._values.update(found)
        self._take_received(layout.keys)

    def _take_received(self, keys: Sequence[Key]) -> None:
        take_twins(self._values, keys, self._twins)
        self._drive.received()
        if not self.is_wanted and _CONTROL in keys:
            self.is_wanted = self._values[_CONTROL] != 0

    def transmit(self, pdo: int) -> bytes:
        """Return process data."""
        layout = self._process_data.layout(pdo)
        return layout.packing.pack(*map(self._dictionary.value, layout.keys))

    # Bus and run.

    def begin_operation(self) -> None:
        """Note that the bus has entered the state operational."""
        self._drive.begin_operation()

    def end_operation(self, is_lost: bool) -> None:
        """Note that the bus has left it."""
        self._drive.end_operation(is_lost)

    def restart(self, *, is_whole: bool) -> None:
        """Return to power-on; see `BusDevice.restart`."""
        self._process_data.restart()
        if is_whole:
            self._changes |= {one.name: one.value for key, one in self._tunables.items()
                              if self._values[key] != one.value}
            self._dictionary.restart()
            self._faults.restart()
            delete_messages(self._values)
        self._drive.restart(is_whole)

    def emergencies(self) -> list[Emergency]:
        """Return the emergency messages since the last call."""
        return self._faults.emergencies()

    def take_sample(self, sample: np.void, tick: int) -> None:
        """Take the sample at the start of a tick."""
        self._axis.take_sample(sample)
        self._t_ns = tick * self._axis.step_ns
        self._faults.take_trips(int(self._axis.field('trips')))
        self._drive.take_sample()

    def fill_command(self, command: np.void) -> None:
        """Write the `COMMAND` of this tick."""
        self._drive.fill_command(command)

    def changes(self) -> dict[str, float]:
        """Return gains and limits written since the last call, SI."""
        found, self._changes = self._changes, {}
        return self._drive.limited(found)

    def take_changes(self, values: Mapping[str, float]) -> None:
        """Take what has changed in the REU, SI, by name: show its gains and limits."""
        if LINE in values:
            self._axis.has_emergency_stop = values[LINE] != 0.0
            self._faults.take_emergency_stop(self._axis.has_emergency_stop)
        self._faults.take_reactions(values)
        shown = self._drive.foreign(values)
        for key, one in self._tunables.items():
            if one.name in shown:
                self._values[key] = shown[one.name]


def _measured(axis: Axis, entry: ObjectEntry) -> Callable[[], Value]:
    """Return a function that returns a field of the sample as the entry counts it."""
    place, scale = FIELDS[entry.source], entry.scale
    if not entry.data_type.is_integer:
        return lambda: axis.sample[place]
    low, high = entry.data_type.limits
    return lambda: min(max(round(axis.sample[place] / scale), low), high)
