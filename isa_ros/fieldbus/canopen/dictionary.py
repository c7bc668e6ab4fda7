"""The object dictionary of a node: the objects of its communication, and those of its device."""

from collections.abc import Callable

from isa_ros.fieldbus.canopen.communication import Communication
from isa_ros.fieldbus.canopen.errors import NodeErrors
from isa_ros.fieldbus.device.abort import (
    PDO_TOO_LONG, SdoAbort, UNSUPPORTED_ACCESS, WRONG_STATE)
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.can_identifiers import INVALID, MOST_BYTES
from isa_ros.fieldbus.device.canopen_objects import COB_ID
from isa_ros.fieldbus.device.communication_area import ERROR_REGISTER
from isa_ros.fieldbus.device.process_data import is_mapping

_MAPPINGS = 0x200   # indices of each direction, as far behind the parameters


class NodeDictionary:
    """What SDO reads and writes."""

    def __init__(
            self, device: BusDevice, communication: Communication, errors: NodeErrors, *,
            is_preoperational: Callable[[], bool], follow: Callable[[int], None]) -> None:
        self._device = device
        self._communication = communication
        self._errors = errors
        self._is_preoperational = is_preoperational
        self._follow = follow

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry; raises `SdoAbort`."""
        if index == ERROR_REGISTER and subindex == 0:
            return bytes([self._errors.register])
        if index in self._communication:
            return self._communication.read(index, subindex)
        return self._device.read(index, subindex)

    def write(self, index: int, subindex: int, data: bytes) -> None:
        """Write an entry; raises `SdoAbort`."""
        if index in self._communication:
            self._communication.write(
                index, subindex, data, is_preoperational=self._is_preoperational())
            self._follow(index)
        elif is_mapping(index):
            self._write_mapping(index, subindex, data)
        else:
            self._write_to_device(index, subindex, data)

    def size(self, index: int, subindex: int) -> int:
        """Return the bytes of an entry's type, 0 for a text; raises `SdoAbort`."""
        owner = self._communication if index in self._communication else self._device
        return owner.table.entry(index, subindex).data_type.bits + 7 >> 3

    def _write_mapping(self, index: int, subindex: int, data: bytes) -> None:
        """Write an entry of a mapping, whose PDO must be off, and no longer than a frame."""
        if not self._is_preoperational():
            raise SdoAbort(WRONG_STATE)
        parameters = index - _MAPPINGS
        if parameters in self._communication \
                and not self._communication.value(parameters, COB_ID) & INVALID:
            raise SdoAbort(UNSUPPORTED_ACCESS)
        self._write_to_device(index, subindex, data)
        if self._device.size(index) > MOST_BYTES:
            self._write_to_device(index, 0, b'\0')
            raise SdoAbort(PDO_TOO_LONG)

    def _write_to_device(self, index: int, subindex: int, data: bytes) -> None:
        self._device.write(
            index, subindex, data, is_preoperational=self._is_preoperational())


def mappings(device: BusDevice, first: int) -> list[int]:
    """Return the mappings of a direction that fit into a frame."""
    return [one.index for one in device.table
            if first <= one.index < first + _MAPPINGS and device.size(one.index) <= MOST_BYTES]
