"""States and commands of network management (NMT, CiA 301, 7.3.2)."""

from enum import IntEnum


class NmtState(IntEnum):
    """States of a node, as its heartbeat has them."""

    INITIALISING = 0x00
    STOPPED = 0x04
    OPERATIONAL = 0x05
    PREOPERATIONAL = 0x7F


class NmtCommand(IntEnum):
    """Commands of the NMT master."""

    START = 0x01
    STOP = 0x02
    ENTER_PREOPERATIONAL = 0x80
    RESET_NODE = 0x81
    RESET_COMMUNICATION = 0x82
