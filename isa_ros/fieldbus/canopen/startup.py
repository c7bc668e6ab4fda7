"""The values of a device's objects when the bus was opened, to which a reset returns."""

from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.process_data import is_mapping

_LAST_OF_COMMUNICATION = 0x1FFF


class Startup:
    """The writable values of a device at power-on."""

    def __init__(self, device: BusDevice) -> None:
        self._device = device
        self._values: dict[tuple[int, int], bytes] = {
            (entry.index, entry.subindex): device.read(entry.index, entry.subindex)
            for entry in device.table.entries if entry.access == 'rw'}

    def restore(self, *, is_whole: bool) -> None:
        """Write back the mappings, and with ``is_whole`` (reset node) all other values too."""
        indices = dict.fromkeys(index for index, _ in self._values)
        for index in indices:
            if is_mapping(index):
                self._restore_mapping(index)
        if not is_whole:
            return
        for (index, subindex), data in self._values.items():
            if index > _LAST_OF_COMMUNICATION:
                self._write(index, subindex, data)

    def _restore_mapping(self, index: int) -> None:
        """Switch a mapping off, write its entries, and then their number."""
        own = {key: data for key, data in self._values.items() if key[0] == index}
        self._write(index, 0, b'\0')
        for (_, subindex), data in own.items():
            if subindex:
                self._write(index, subindex, data)
        if (index, 0) in own:
            self._write(index, 0, own[index, 0])

    def _write(self, index: int, subindex: int, data: bytes) -> None:
        """Write a value if it differs; one that the state of the drive refuses stays."""
        try:
            if self._device.read(index, subindex) != data:
                self._device.write(index, subindex, data, is_preoperational=True)
        except SdoAbort:
            return
