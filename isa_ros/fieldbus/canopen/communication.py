"""
The values of the communication objects of a node, 0x1001 to 0x1FFF.

COB-IDs, transmission types and the SYNC are writable while preoperational, and those of a PDO
only while it is off, as CiA 301 has it. An identifier of one service is refused for another: a
node that took its own frame for an RPDO would command itself.
"""

from collections.abc import Sequence

from isa_ros.fieldbus.device.abort import (
    INCOMPATIBLE, NO_DATA, OUT_OF_RANGE, READ_ONLY, SdoAbort, WRITE_ONLY, WRONG_STATE)
from isa_ros.fieldbus.device.can_identifiers import EXTENDED, INVALID, is_restricted, LARGEST
from isa_ros.fieldbus.device.canopen_objects import (
    CANOPEN, COB_ID, CYCLE_PERIOD, EMERGENCY_ID, INHIBIT_TIME, RECEIVE_MAPPINGS,
    RECEIVE_PARAMETERS, SYNC_ID, SYNC_OVERFLOW, SYNC_START, TRANSMISSION, TRANSMIT_MAPPINGS,
    TRANSMIT_PARAMETERS)
from isa_ros.fieldbus.device.communication_area import ERROR_FIELD, ERROR_REGISTER, ERRORS_KEPT
from isa_ros.fieldbus.device.dictionary import refuse_beyond
from isa_ros.fieldbus.device.objects import ObjectTable, Value

MOST_SYNCS = 240        # transmission types up to it are synchronous
_EVENT_TYPES = (254, 255)
_WHILE_PREOPERATIONAL = (SYNC_ID, CYCLE_PERIOD, SYNC_OVERFLOW)
_MAPPING_INDICES = (*range(RECEIVE_MAPPINGS, TRANSMIT_PARAMETERS),
                    *range(TRANSMIT_MAPPINGS, TRANSMIT_MAPPINGS + 0x200))


class Communication:
    """The values of the communication objects of a node."""

    def __init__(self, table: ObjectTable, node: int) -> None:
        """``table`` is that of the device; it has these objects, those of errors, and others."""
        self.table = ObjectTable([
            one for one in table if one.bus == CANOPEN and one.index not in _MAPPING_INDICES
            or one.index in (ERROR_REGISTER, ERROR_FIELD)])
        self.node = node
        """Number that defaults grow by at the next reset."""
        self._values: dict[tuple[int, int], Value] = {}
        self._identifiers = [
            (one.index, COB_ID if one.index >= RECEIVE_PARAMETERS else 0) for one in self.table
            if one.index in (SYNC_ID, EMERGENCY_ID) or one.index >= RECEIVE_PARAMETERS]
        self.reset()

    def __contains__(self, index: object) -> bool:
        """Return whether an index is one of these objects."""
        return index in self.table

    def reset(self) -> None:
        """Set all values to those at power-on."""
        self._values = {
            (one.index, one.subindex):
                int(one.default) + self.node if one.adds_node else one.default
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
        if index == ERROR_FIELD and subindex > self.value(ERROR_FIELD):
            raise SdoAbort(NO_DATA)
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
        self._values[ERROR_FIELD, 0] = len(codes)
        for k in range(ERRORS_KEPT):
            self._values[ERROR_FIELD, k + 1] = codes[k] if k < len(codes) else 0

    def _refuse(self, index: int, subindex: int, value: int, is_preoperational: bool) -> None:
        if index in _WHILE_PREOPERATIONAL or index >= RECEIVE_PARAMETERS:
            if not is_preoperational:
                raise SdoAbort(WRONG_STATE)
        if index in (SYNC_ID, EMERGENCY_ID):
            _refuse_identifier(value)
            if index == SYNC_ID and value & ~LARGEST:  # generates it, or is off
                raise SdoAbort(OUT_OF_RANGE)
            self._refuse_taken(index, value)
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
            self._refuse_taken(index, value)
        elif subindex == TRANSMISSION:
            if value > MOST_SYNCS and value not in _EVENT_TYPES:
                raise SdoAbort(OUT_OF_RANGE)
        elif subindex in (INHIBIT_TIME, SYNC_START) and is_on and is_transmit:
            raise SdoAbort(WRONG_STATE)

    def _refuse_taken(self, index: int, value: int) -> None:
        """Refuse an identifier of another object that is on; RPDOs may share one."""
        if value & INVALID:
            return
        is_receive = RECEIVE_PARAMETERS <= index < RECEIVE_MAPPINGS
        for other, subindex in self._identifiers:
            cob_id = self.value(other, subindex)
            is_alike = is_receive and RECEIVE_PARAMETERS <= other < RECEIVE_MAPPINGS
            if other != index and not is_alike and not cob_id & INVALID \
                    and not (cob_id ^ value) & LARGEST:
                raise SdoAbort(INCOMPATIBLE)


def _refuse_identifier(value: int) -> None:
    if value & EXTENDED or not value & INVALID and is_restricted(value & EXTENDED - 1):
        raise SdoAbort(OUT_OF_RANGE)
