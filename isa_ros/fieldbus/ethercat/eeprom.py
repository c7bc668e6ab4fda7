"""Access of a master to the SII through registers 0x0500 to 0x050F."""

from isa_ros.fieldbus.ethercat.registers import (
    EEPROM_ADDRESS, EEPROM_CONFIGURATION, EEPROM_CONTROL, EEPROM_WORDS, STATION_ALIAS)
from isa_ros.fieldbus.ethercat.sii import ALIAS_WORD, checksum, CHECKSUM_WORD

_WRITE_ENABLE, _READS_8_BYTES = 0x0001, 0x0040
_COMMAND, _NOTHING, _READ, _WRITE, _RELOAD = 0x0700, 0x0000, 0x0100, 0x0200, 0x0400
_CHECKSUM_WRONG, _REFUSED, _NOT_ENABLED = 0x0800, 0x2000, 0x4000


class Eeprom:
    """The SII and its registers; written words last until the line is closed."""

    def __init__(self, memory: bytearray, image: bytearray) -> None:
        self._memory, self.image = memory, image
        self.reload()

    def reload(self) -> int:
        """Load the station alias; return the error bits of the control register."""
        is_right = checksum(self.image[:2 * CHECKSUM_WORD]) == self.image[2 * CHECKSUM_WORD]
        if not is_right:
            return _CHECKSUM_WRONG
        STATION_ALIAS.put(
            self._memory, int.from_bytes(self.image[2 * ALIAS_WORD:2 * ALIAS_WORD + 2], 'little'))
        return 0

    def execute(self) -> None:
        """Execute the command in the control register, at once."""
        control = EEPROM_CONTROL.value(self._memory)
        errors = self._executed(control)
        EEPROM_CONTROL.put(self._memory, _READS_8_BYTES | errors)

    def _executed(self, control: int) -> int:
        """Execute a command; return the error bits."""
        command, at = control & _COMMAND, 2 * EEPROM_ADDRESS.value(self._memory)
        if command == _NOTHING:
            return 0
        if self._memory[EEPROM_CONFIGURATION.address] & 1 or command not in (
                _READ, _WRITE, _RELOAD):
            return _REFUSED
        if command == _READ:
            words = bytes(self.image[at:at + EEPROM_WORDS.size])
            EEPROM_WORDS.put(self._memory, int.from_bytes(
                words.ljust(EEPROM_WORDS.size, b'\xff'), 'little'))
            return 0
        if command == _RELOAD:
            return self.reload()
        if not control & _WRITE_ENABLE:
            return _NOT_ENABLED
        if at + 2 > len(self.image):
            return _REFUSED
        self.image[at:at + 2] = self._memory[EEPROM_WORDS.address:EEPROM_WORDS.address + 2]
        return 0
