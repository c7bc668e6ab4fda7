"""Identifiers of CANopen frames: the pre-defined connection set of CiA 301."""

NMT = 0x000
SYNC = 0x080
EMERGENCY = 0x080           # + node
TRANSMIT = (0x180, 0x280, 0x380, 0x480)     # + node: TPDO 1 to 4, to the master
RECEIVE = (0x200, 0x300, 0x400, 0x500)      # + node: RPDO 1 to 4, from the master
SDO_ANSWER = 0x580          # + node
SDO_REQUEST = 0x600         # + node
HEARTBEAT = 0x700           # + node; also the boot-up message

FIRST_NODE, LAST_NODE = 1, 127
MOST_BYTES = 8              # of a data frame of classical CAN
LARGEST = 0x7FF             # 11 bits

INVALID = 1 << 31           # bit of a COB-ID: the object is off
EXTENDED = 1 << 29          # bit of a COB-ID: 29 bits

_RESTRICTED = (
    (0x000, 0x07F), (0x101, 0x180), (0x581, 0x5FF), (0x601, 0x67F), (0x6E0, 0x6FF),
    (0x701, LARGEST))


def is_restricted(identifier: int) -> bool:
    """Return whether no PDO, SYNC or EMCY may have this identifier (CiA 301, table 41)."""
    return identifier > LARGEST or any(low <= identifier <= high for low, high in _RESTRICTED)
