"""
The communication objects of a node, 0x1001 to 0x1FFF: what CANopen adds to an actuator's table.

`communication_objects` and `pdo_parameters` are part of the table, so that dictionary and EDS have
the same; a `Communication` keeps their values for one node. COB-IDs, transmission types and the
SYNC are writable while preoperational, and those of a PDO only while it is off, as CiA 301 has it.
"""

from collections.abc import Sequence

from isa_ros.fieldbus.canopen.identifiers import (
    EMERGENCY, EXTENDED, INVALID, is_restricted, LARGEST, RECEIVE, SDO_ANSWER, SDO_REQUEST, SYNC,
    TRANSMIT)
from isa_ros.fieldbus.device.abort import (
    OUT_OF_RANGE, READ_ONLY, SdoAbort, WRITE_ONLY, WRONG_STATE)
from isa_ros.fieldbus.device.dictionary import refuse_beyond
from isa_ros.fieldbus.device.objects import (
    DataType, Entry, Kind, Object, ObjectTable, record_of, Value, variable)

ERROR_REGISTER, ERROR_HISTORY = 0x1001, 0x1003
SYNC_ID, CYCLE_PERIOD, SYNC_OVERFLOW = 0x1005, 0x1006, 0x1019
EMERGENCY_ID = 0x1014
HEARTBEAT_CONSUMED, HEARTBEAT_PRODUCED = 0x1016, 0x1017
ERROR_BEHAVIOUR = 0x1029
SDO_SERVER = 0x1200
RECEIVE_PARAMETERS, RECEIVE_MAPPINGS = 0x1400, 0x1600
TRANSMIT_PARAMETERS, TRANSMIT_MAPPINGS = 0x1800, 0x1A00
ERRORS_KEPT = 8
CONSUMERS = 4           # producers of a heartbeat that a node can watch

# Subindices of the parameters of a PDO.
COB_ID, TRANSMISSION, INHIBIT_TIME, EVENT_TIMER, SYNC_START = 1, 2, 3, 5, 6
MOST_SYNCS = 240        # transmission types up to it are synchronous
_EVENT_TYPES = (254, 255)
_BUS = 'canopen'
_NS_PER_US = 1000
_MICROSECOND, _MILLISECOND, _INHIBIT = 1e-6, 1e-3, 1e-4     # s of a count
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
_WHILE_PREOPERATIONAL = (SYNC_ID, CYCLE_PERIOD, SYNC_OVERFLOW)
_MAPPING_INDICES = (*range(RECEIVE_MAPPINGS, TRANSMIT_PARAMETERS),
                    *range(TRANSMIT_MAPPINGS, TRANSMIT_MAPPINGS + 0x200))


def communication_objects(step_ns: int) -> list[Object]:
    """Return the services of CANopen without the PDOs, of a run with this tick."""
    cycle_us = step_ns // _NS_PER_US
    return [
        variable(Entry(SYNC_ID, 0, 'COB-ID SYNC', _U32, 'rw', SYNC, meaning='the tick'), _BUS),
        variable(Entry(CYCLE_PERIOD, 0, 'Communication cycle period', _U32, 'rw', cycle_us, 's',
                       _MICROSECOND, choices=(0, cycle_us), meaning='the tick; 0: not checked'),
                 _BUS),
        variable(Entry(EMERGENCY_ID, 0, 'COB-ID EMCY', _U32, 'rw', EMERGENCY, adds_node=True,
                       meaning='bit 31: off'), _BUS),
        Object(HEARTBEAT_CONSUMED, 'Consumer heartbeat time', Kind.ARRAY, (
            Entry(HEARTBEAT_CONSUMED, 0, 'Highest subindex', _U8, 'const', CONSUMERS),
            *(Entry(HEARTBEAT_CONSUMED, k, f'Consumer heartbeat time {k}', _U32, 'rw',
                    meaning='node << 16 | ms of simulated time; 0: off')
              for k in range(1, CONSUMERS + 1))), _BUS),
        variable(Entry(HEARTBEAT_PRODUCED, 0, 'Producer heartbeat time', _U16, 'rw', 0, 's',
                       _MILLISECOND, meaning='wall time; 0: off'), _BUS),
        variable(Entry(SYNC_OVERFLOW, 0, 'Synchronous counter overflow value', _U8, 'rw',
                       meaning='0: SYNC without a counter; 2 to 240: the highest counter'), _BUS),
        record_of(ERROR_BEHAVIOUR, 'Error behaviour', [
            Entry(ERROR_BEHAVIOUR, 1, 'Communication error', _U8, 'rw', choices=(0, 1, 2),
                  meaning='0: preoperational, 1: no change, 2: stopped')], _BUS),
        record_of(SDO_SERVER, 'SDO server parameter', [
            Entry(SDO_SERVER, 1, 'COB-ID client to server', _U32, 'const', SDO_REQUEST,
                  adds_node=True),
            Entry(SDO_SERVER, 2, 'COB-ID server to client', _U32, 'const', SDO_ANSWER,
                  adds_node=True)], _BUS)]


def pdo_parameters(mapping: int, *, is_on: bool) -> Object:
    """Return the communication parameters of the PDO with this mapping; on at power-on or not."""
    if mapping < TRANSMIT_MAPPINGS:
        place, index, bases = mapping - RECEIVE_MAPPINGS, RECEIVE_PARAMETERS, RECEIVE
        kinds = '0 to 240: with the next SYNC; 254, 255: at once'
        timer = 'simulated time without it that is an error; 0: off'
    else:
        place, index, bases = mapping - TRANSMIT_MAPPINGS, TRANSMIT_PARAMETERS, TRANSMIT
        kinds = '0: after a SYNC, if changed; n to 240: after every n-th; 254, 255: if changed'
        timer = 'of types 254 and 255: longest time between two; 0: off'
    index += place
    is_transmit = bases is TRANSMIT
    rows = [
        Entry(index, COB_ID, 'COB-ID', _U32, 'rw', bases[place] | (0 if is_on else INVALID),
              adds_node=True, meaning='bit 31: off'),
        Entry(index, TRANSMISSION, 'Transmission type', _U8, 'rw', 1, meaning=kinds)]
    if is_transmit:
        rows.append(Entry(index, INHIBIT_TIME, 'Inhibit time', _U16, 'rw', 0, 's', _INHIBIT,
                          meaning='of types 254 and 255: shortest time between two'))
    rows.append(Entry(index, EVENT_TIMER, 'Event timer', _U16, 'rw', 0, 's', _MILLISECOND,
                      meaning=timer))
    if is_transmit:
        rows.append(Entry(index, SYNC_START, 'SYNC start value', _U8, 'rw',
                          meaning='counter of the first SYNC; 0: any'))
    return record_of(index, f'{"TPDO" if is_transmit else "RPDO"} {place + 1} communication '
                     'parameter', rows, _BUS)


class Communication:
    """The values of the communication objects of a node."""

    def __init__(self, table: ObjectTable, node: int) -> None:
        """``table`` is that of the device; it has these objects, those of errors, and others."""
        self.table = ObjectTable([
            one for one in table if one.bus == _BUS and one.index not in _MAPPING_INDICES
            or one.index in (ERROR_REGISTER, ERROR_HISTORY)])
        self._node = node
        self._values: dict[tuple[int, int], Value] = {}
        self.reset()

    def __contains__(self, index: object) -> bool:
        """Return whether an index is one of these objects."""
        return index in self.table

    def reset(self) -> None:
        """Set all values to those at power-on."""
        self._values = {
            (one.index, one.subindex):
                int(one.default) + self._node if one.adds_node else one.default
            for one in self.table.entries}

    def value(self, index: int, subindex: int = 0) -> int:
        """Return a value; all of these are whole numbers."""
        return int(self._values[index, subindex])

    def values(self, index: int) -> list[int]:
        """Return the values of an array, without subindex 0."""
        return [self.value(index, entry.subindex)
                for entry in self.table.at(index).entries if entry.subindex]

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry; raises `SdoAbort`."""
        entry = self.table.entry(index, subindex)
        if not entry.is_readable:
            raise SdoAbort(WRITE_ONLY)
        return entry.data_type.pack(self._values[index, subindex])

    def write(self, index: int, subindex: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write an entry; raises `SdoAbort`."""
        entry = self.table.entry(index, subindex)
        if not entry.is_writable:
            raise SdoAbort(READ_ONLY)
        value = int(entry.data_type.unpack(data))
        refuse_beyond(entry, value)
        self._refuse(index, subindex, value, is_preoperational)
        self._values[index, subindex] = value

    def keep_errors(self, codes: Sequence[int]) -> None:
        """Set the history of errors, the newest first."""
        self._values[ERROR_HISTORY, 0] = len(codes)
        for k in range(ERRORS_KEPT):
            self._values[ERROR_HISTORY, k + 1] = codes[k] if k < len(codes) else 0

    def _refuse(self, index: int, subindex: int, value: int, is_preoperational: bool) -> None:
        if index in _WHILE_PREOPERATIONAL or index >= RECEIVE_PARAMETERS:
            if not is_preoperational:
                raise SdoAbort(WRONG_STATE)
        if index in (SYNC_ID, EMERGENCY_ID):
            _refuse_identifier(value)
            if index == SYNC_ID and value & ~LARGEST:  # generates it, or is off
                raise SdoAbort(OUT_OF_RANGE)
        elif index == SYNC_OVERFLOW and (value == 1 or value > MOST_SYNCS):
            raise SdoAbort(OUT_OF_RANGE)
        elif index >= RECEIVE_PARAMETERS:
            self._refuse_of_pdo(index, subindex, value)

    def _refuse_of_pdo(self, index: int, subindex: int, value: int) -> None:
        is_transmit = index >= TRANSMIT_PARAMETERS
        is_on = not self.value(index, COB_ID) & INVALID
        if subindex == COB_ID:
            _refuse_identifier(value)
            if is_on and not value & INVALID and (value ^ self.value(index, COB_ID)) & LARGEST:
                raise SdoAbort(WRONG_STATE)
        elif subindex == TRANSMISSION:
            if value > MOST_SYNCS and value not in _EVENT_TYPES:
                raise SdoAbort(OUT_OF_RANGE)
        elif subindex in (INHIBIT_TIME, SYNC_START) and is_on and is_transmit:
            raise SdoAbort(WRONG_STATE)


def _refuse_identifier(value: int) -> None:
    if value & EXTENDED or not value & INVALID and is_restricted(value & EXTENDED - 1):
        raise SdoAbort(OUT_OF_RANGE)
