"""What a node does with the frame of an RPDO: check its length, then keep it until its SYNC."""

from collections.abc import Callable

from isa_ros.fieldbus.canopen.errors import (
    NO_ERROR, NodeErrors, PDO_OVERDUE, PDO_TOO_LONG, PDO_TOO_SHORT)
from isa_ros.fieldbus.canopen.pdo import ReceivePdo
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.canopen_objects import RECEIVE_MAPPINGS

Handler = Callable[[bytes], bool]
"""Handles the data of a frame; returns whether a cycle has begun."""


def pdo_handler(pdo: ReceivePdo, device: BusDevice, errors: NodeErrors) -> Handler:
    """Return what handles the frames of an RPDO; one that is too short is not used."""
    number = pdo.mapping - RECEIVE_MAPPINGS + 1

    def take(data: bytes) -> bool:
        code = (PDO_TOO_SHORT if len(data) < pdo.size
                else PDO_TOO_LONG if len(data) > pdo.size else NO_ERROR)
        if code and not errors.is_present(code, number):
            errors.begin(code, number, is_sent=True)
        for other in (PDO_TOO_SHORT, PDO_TOO_LONG):
            if other != code:
                errors.end(other, number, is_sent=True)
        if code == PDO_TOO_SHORT:
            return False
        errors.end(PDO_OVERDUE, number, is_sent=True)
        pdo.take(data, device)
        return False
    return take
