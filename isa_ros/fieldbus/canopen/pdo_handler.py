"""What a node does with the frame of an RPDO: check its length, then keep it until its SYNC."""

from collections.abc import Callable

from isa_ros.fieldbus.canopen.errors import (
    NodeErrors, PDO_OVERDUE, PDO_TOO_LONG, PDO_TOO_SHORT)
from isa_ros.fieldbus.canopen.pdo import ReceivePdo
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.canopen_objects import RECEIVE_MAPPINGS

Handler = Callable[[bytes], bool]
"""Handles the data of a frame; returns whether a cycle has begun."""


def pdo_handler(pdo: ReceivePdo, device: BusDevice, errors: NodeErrors) -> Handler:
    """Return what handles the frames of an RPDO; one that is too short is not used."""
    number = pdo.mapping - RECEIVE_MAPPINGS + 1

    def take(data: bytes) -> bool:
        if len(data) != pdo.size:
            if not pdo.has_wrong_length:
                code = PDO_TOO_SHORT if len(data) < pdo.size else PDO_TOO_LONG
                errors.begin(code, number, is_sent=True)
            pdo.has_wrong_length = True
            if len(data) < pdo.size:
                return False
        elif pdo.has_wrong_length:
            pdo.has_wrong_length = False
            for code in (PDO_TOO_SHORT, PDO_TOO_LONG):
                errors.end(code, number, is_sent=True)
        errors.end(PDO_OVERDUE, number, is_sent=True)
        pdo.take(data, device)
        return False
    return take
