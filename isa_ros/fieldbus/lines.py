"""The kinds of buses; add a new one here. A run imports the modules of its own bus only."""

from collections.abc import Sequence

from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.request import BusRequest, CANOPEN, ETHERCAT, MIT, SERIAL
from isa_ros.fieldbus.session import OpenLine


def line_of(request: BusRequest) -> OpenLine:
    """Return what opens the line of a request; it raises `ConfigError` where it cannot."""
    if request.bus == ETHERCAT:
        from isa_ros.fieldbus.ethercat.line import ethercat_line
        return lambda devices, step_ns: ethercat_line(devices, request.interface, step_ns)
    if request.bus == CANOPEN:
        from isa_ros.fieldbus.canopen.line import canopen_line
        return lambda devices, step_ns: canopen_line(
            devices, request.interface, request.channel, step_ns, bitrate=request.bitrate,
            first_node=request.first_node)
    if request.bus == MIT:
        from isa_ros.fieldbus.canopen.mit_line import mit_line
        return lambda devices, step_ns: mit_line(
            devices, request.interface, request.channel, step_ns, bitrate=request.bitrate,
            first_node=request.first_node)
    from isa_ros.fieldbus.serial.line import serial_line
    return lambda devices, step_ns: serial_line(
        devices, request.path, request.baud, step_ns)


def refuse_unusable(request: BusRequest, devices: Sequence[BusDevice], step_ns: int) -> None:
    """
    Refuse a line that cannot be opened or is too slow, before kernels are compiled for it.

    Nothing is sent on it.

    Raises
    ------
    ConfigError
        The interface does not exist, is down, or needs a permission or a package; or the frames
        of a tick do not fit.

    """
    if request.bus == ETHERCAT:
        from isa_ros.fieldbus.ethercat.interface import open_interface
        open_interface(request.interface).close()
    elif request.bus == SERIAL:
        from isa_ros.fieldbus.serial.line import default_baud, refuse_overfull
        from isa_ros.fieldbus.serial.port import SerialPort
        refuse_overfull(devices, request.baud or default_baud(), step_ns)
        SerialPort(request.path, request.baud or default_baud()).close()
    else:
        _refuse_can(request, devices, step_ns)


def _refuse_can(request: BusRequest, devices: Sequence[BusDevice], step_ns: int) -> None:
    from isa_ros.fieldbus.canopen.line import default_bitrate, planned_line
    from isa_ros.fieldbus.canopen.mit_line import refuse_motors
    from isa_ros.fieldbus.canopen.port import CanPort
    bitrate = request.bitrate or default_bitrate()
    refuse = refuse_motors if request.bus == MIT else planned_line
    refuse(devices, step_ns, bitrate, request.first_node)
    CanPort(request.interface, request.channel, bitrate).close()
