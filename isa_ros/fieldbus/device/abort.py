"""
Abort codes of SDO transfers (CiA 301, table 22; ETG.1000.6), as data.

A device refuses an access with one of them; CANopen and EtherCAT send the same number.
"""

from collections.abc import Mapping

TOGGLE_BIT = 0x05030000
TIMEOUT = 0x05040000
UNKNOWN_COMMAND = 0x05040001
INVALID_BLOCK_SIZE = 0x05040002
INVALID_SEQUENCE = 0x05040003
CRC_ERROR = 0x05040004
OUT_OF_MEMORY = 0x05040005
UNSUPPORTED_ACCESS = 0x06010000
WRITE_ONLY = 0x06010001
READ_ONLY = 0x06010002
NOT_EMPTIED_FIRST = 0x06010003
NO_COMPLETE_ACCESS = 0x06010004
NO_OBJECT = 0x06020000
NOT_MAPPABLE = 0x06040041
PDO_TOO_LONG = 0x06040042
INCOMPATIBLE = 0x06040043
HARDWARE = 0x06060000
WRONG_LENGTH = 0x06070010
TOO_LONG = 0x06070012
TOO_SHORT = 0x06070013
NO_SUBINDEX = 0x06090011
OUT_OF_RANGE = 0x06090030
TOO_HIGH = 0x06090031
TOO_LOW = 0x06090032
GENERAL = 0x08000000
NOT_TRANSFERABLE = 0x08000020
LOCAL_CONTROL = 0x08000021
WRONG_STATE = 0x08000022
NO_DATA = 0x08000024

MEANINGS: Mapping[int, str] = {
    TOGGLE_BIT: 'toggle bit not alternated',
    TIMEOUT: 'SDO protocol timed out',
    UNKNOWN_COMMAND: 'command specifier not valid or unknown',
    INVALID_BLOCK_SIZE: 'invalid block size',
    INVALID_SEQUENCE: 'invalid sequence number',
    CRC_ERROR: 'CRC error',
    OUT_OF_MEMORY: 'out of memory',
    UNSUPPORTED_ACCESS: 'unsupported access to an object',
    WRITE_ONLY: 'attempt to read a write only object',
    READ_ONLY: 'attempt to write a read only object',
    NOT_EMPTIED_FIRST: 'subindex cannot be written, subindex 0 must be 0 for write access',
    NO_COMPLETE_ACCESS: 'complete access not supported for this object',
    NO_OBJECT: 'object does not exist in the object dictionary',
    NOT_MAPPABLE: 'object cannot be mapped to the PDO',
    PDO_TOO_LONG: 'the mapped objects would exceed the length of the PDO',
    INCOMPATIBLE: 'general parameter incompatibility',
    HARDWARE: 'access failed due to a hardware error',
    WRONG_LENGTH: 'data type does not match, length of the parameter does not match',
    TOO_LONG: 'data type does not match, length of the parameter too high',
    TOO_SHORT: 'data type does not match, length of the parameter too low',
    NO_SUBINDEX: 'subindex does not exist',
    OUT_OF_RANGE: 'invalid value of the parameter',
    TOO_HIGH: 'value of the parameter too high',
    TOO_LOW: 'value of the parameter too low',
    GENERAL: 'general error',
    NOT_TRANSFERABLE: 'data cannot be transferred or stored to the application',
    LOCAL_CONTROL: 'data cannot be transferred or stored because of local control',
    WRONG_STATE: 'data cannot be transferred or stored in the present state of the device',
    NO_DATA: 'no data available',
}
"""Meaning of each code."""


class SdoAbort(Exception):
    """An access to the object dictionary that is refused with a code of `MEANINGS`."""

    def __init__(self, code: int, reason: str = '') -> None:
        self.code = code
        self.reason = reason
        """What was refused and why, as object 0x2003 says it; '': the meaning says enough."""
        self.meaning = MEANINGS[code]
        super().__init__(f'0x{code:08X}: {self.meaning}')
