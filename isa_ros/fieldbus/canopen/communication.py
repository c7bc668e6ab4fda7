"""
The communication objects of a node, 0x1001 to 0x1FFF: what CANopen adds to an actuator's table.

They are data like the table: `communication_objects` makes them for a node, and EDS and dictionary
have the same. COB-IDs, transmission types and the SYNC are writable while preoperational, and
those of a PDO only while it is off, as CiA 301 has it.
"""

from collections.abc import Mapping, Sequence

from isa_ros.fieldbus.abort import (
    OUT_OF_RANGE, READ_ONLY, SdoAbort, TOO_HIGH, TOO_LOW, WRITE_ONLY, WRONG_STATE)
from isa_ros.fieldbus.canopen.identifiers import (
    EMERGENCY, EXTENDED, INVALID, is_restricted, LARGEST, RECEIVE, SDO_ANSWER, SDO_REQUEST, SYNC,
    TRANSMIT)
from isa_ros.fieldbus.objects import DataType, Entry, Kind, Object, ObjectTable, Value

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
_PDOS_ON = 2            # of each direction, at the start
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32


def communication_objects(
        node: int, receive: Sequence[int], transmit: Sequence[int], cycle_us: int) -> list[Object]:
    """
    Return the communication objects of a node.

    ``receive`` and ``transmit`` are the mappings of the device, 0x1600 on and 0x1A00 on.
    """
    return [
        _var(ERROR_REGISTER, 'Error register', _U8, 'ro',
             meaning='bit 0 any, 1 current, 2 voltage, 3 temperature, 4 communication, 5 profile'),
        _errors(),
        _var(SYNC_ID, 'COB-ID SYNC', _U32, default=SYNC, meaning='the tick'),
        _var(CYCLE_PERIOD, 'Communication cycle period', _U32, default=cycle_us,
             meaning='us; the tick of the run, or 0: not checked'),
        _var(EMERGENCY_ID, 'COB-ID EMCY', _U32, default=EMERGENCY + node),
        _array(HEARTBEAT_CONSUMED, 'Consumer heartbeat time', [0] * CONSUMERS,
               'node << 16 | ms of simulated time; 0: off'),
        _var(HEARTBEAT_PRODUCED, 'Producer heartbeat time', _U16,
             meaning='ms of wall time; 0: off'),
        _var(SYNC_OVERFLOW, 'Synchronous counter overflow value', _U8,
             meaning='0: SYNC without counter; 2 to 240: the highest counter'),
        _record(ERROR_BEHAVIOUR, 'Error behaviour', [
            (1, 'Communication error', _U8, 'rw', 0,
             '0: preoperational, 1: no change, 2: stopped')]),
        _record(SDO_SERVER, 'SDO server parameter', [
            (1, 'COB-ID client to server', _U32, 'ro', SDO_REQUEST + node, ''),
            (2, 'COB-ID server to client', _U32, 'ro', SDO_ANSWER + node, '')]),
        *(_receive_parameters(mapping, node) for mapping in receive),
        *(_transmit_parameters(mapping, node) for mapping in transmit)]


class Communication:
    """The values of the communication objects of a node."""

    def __init__(self, objects: Sequence[Object]) -> None:
        self.table = ObjectTable(objects)
        self._values: dict[tuple[int, int], Value] = {}
        self.cycle_us = self._default(CYCLE_PERIOD, 0)
        self.reset()

    def __contains__(self, index: object) -> bool:
        """Return whether an index is one of these objects."""
        return index in self.table

    def reset(self) -> None:
        """Set all values to those at power-on."""
        self._values = {(one.index, one.subindex): one.default for one in self.table.entries}

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
        if value > entry.high:
            raise SdoAbort(TOO_HIGH)
        if value < entry.low:
            raise SdoAbort(TOO_LOW)
        self._refuse(index, subindex, value, is_preoperational)
        self._values[index, subindex] = value

    def keep_errors(self, codes: Sequence[int]) -> None:
        """Set the history of errors, the newest first."""
        self._values[ERROR_HISTORY, 0] = len(codes)
        for k in range(ERRORS_KEPT):
            self._values[ERROR_HISTORY, k + 1] = codes[k] if k < len(codes) else 0

    def _default(self, index: int, subindex: int) -> int:
        return int(self.table.entry(index, subindex).default)

    def _refuse(self, index: int, subindex: int, value: int, is_preoperational: bool) -> None:
        if index in _WHILE_PREOPERATIONAL or index >= RECEIVE_PARAMETERS:
            if not is_preoperational:
                raise SdoAbort(WRONG_STATE)
        if index == ERROR_HISTORY and value:
            raise SdoAbort(OUT_OF_RANGE)
        if index in (SYNC_ID, EMERGENCY_ID):
            _refuse_identifier(value)
            if index == SYNC_ID and value & ~LARGEST:  # generates it, or is off
                raise SdoAbort(OUT_OF_RANGE)
        elif index == CYCLE_PERIOD and value not in (0, self.cycle_us):
            raise SdoAbort(OUT_OF_RANGE)
        elif index == SYNC_OVERFLOW and value == 1:
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
            if not (value <= MOST_SYNCS or value in _EVENT_TYPES):
                raise SdoAbort(OUT_OF_RANGE)
        elif subindex in (INHIBIT_TIME, SYNC_START) and is_on and is_transmit:
            raise SdoAbort(WRONG_STATE)


_WHILE_PREOPERATIONAL = (SYNC_ID, CYCLE_PERIOD, SYNC_OVERFLOW)


def _refuse_identifier(value: int) -> None:
    if value & EXTENDED or not value & INVALID and is_restricted(value & EXTENDED - 1):
        raise SdoAbort(OUT_OF_RANGE)


def _receive_parameters(mapping: int, node: int) -> Object:
    k = mapping - RECEIVE_MAPPINGS
    return _record(RECEIVE_PARAMETERS + k, f'RPDO {k + 1} communication parameter', [
        (COB_ID, 'COB-ID', _U32, 'rw', _cob_id(RECEIVE, k, node), 'bit 31: off'),
        (TRANSMISSION, 'Transmission type', _U8, 'rw', 1,
         '0 to 240: with the next SYNC; 254, 255: at once'),
        (EVENT_TIMER, 'Event timer', _U16, 'rw', 0,
         'ms of simulated time without it that are an error; 0: off')])


def _transmit_parameters(mapping: int, node: int) -> Object:
    k = mapping - TRANSMIT_MAPPINGS
    return _record(TRANSMIT_PARAMETERS + k, f'TPDO {k + 1} communication parameter', [
        (COB_ID, 'COB-ID', _U32, 'rw', _cob_id(TRANSMIT, k, node), 'bit 31: off'),
        (TRANSMISSION, 'Transmission type', _U8, 'rw', 1,
         '0: after a SYNC, if changed; n to 240: after every n-th; 254, 255: if changed'),
        (INHIBIT_TIME, 'Inhibit time', _U16, 'rw', 0, '100 us, of types 254 and 255'),
        (EVENT_TIMER, 'Event timer', _U16, 'rw', 0, 'ms, of types 254 and 255'),
        (SYNC_START, 'SYNC start value', _U8, 'rw', 0, 'counter of the first SYNC; 0: any')])


def _cob_id(bases: Sequence[int], k: int, node: int) -> int:
    if k >= len(bases):
        return INVALID
    return bases[k] + node | (0 if k < _PDOS_ON else INVALID)


def _errors() -> Object:
    return Object(ERROR_HISTORY, 'Pre-defined error field', Kind.ARRAY, (
        Entry(ERROR_HISTORY, 0, 'Number of errors', _U8, 'rw', meaning='0 clears them'),
        *(Entry(ERROR_HISTORY, k, f'Error {k}', _U32, meaning='code; the newest is error 1')
          for k in range(1, ERRORS_KEPT + 1))), bus='canopen')


def _var(index: int, name: str, data_type: DataType, access: str = 'rw', default: int = 0,
         meaning: str = '') -> Object:
    high: Mapping[int, float] = {SYNC_OVERFLOW: MOST_SYNCS}
    entry = Entry(index, 0, name, data_type, access, default, meaning=meaning,
                  high=high.get(index, float('inf')))
    return Object(index, name, Kind.VAR, (entry,), bus='canopen')


def _array(index: int, name: str, defaults: Sequence[int], meaning: str) -> Object:
    return Object(index, name, Kind.ARRAY, (
        Entry(index, 0, 'Highest subindex', _U8, 'const', len(defaults)),
        *(Entry(index, k, f'{name} {k}', _U32, 'rw', default, meaning=meaning)
          for k, default in enumerate(defaults, 1))), bus='canopen')


def _record(index: int, name: str,
            rows: Sequence[tuple[int, str, DataType, str, int, str]]) -> Object:
    return Object(index, name, Kind.RECORD, (
        Entry(index, 0, 'Highest subindex', _U8, 'const', rows[-1][0]),
        *(Entry(index, subindex, text, data_type, access, default, meaning=meaning,
                high=2 if index == ERROR_BEHAVIOUR else float('inf'))
          for subindex, text, data_type, access, default, meaning in rows)), bus='canopen')
