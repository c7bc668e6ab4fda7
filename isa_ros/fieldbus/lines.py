"""The kinds of buses; add a new one here. A run imports the modules of its own bus only."""

from isa_ros.fieldbus.request import BusRequest, CANOPEN, ETHERCAT, MIT
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
    from isa_ros.fieldbus.serial_line import serial_line
    return lambda devices, step_ns: serial_line(
        devices, request.path, request.baud, step_ns)


def refuse_unusable(request: BusRequest) -> None:
    """
    Refuse an interface that cannot be opened, before kernels are compiled for it.

    Raises
    ------
    ConfigError
        It does not exist, is down, or needs a permission.

    """
    if request.bus == ETHERCAT:
        from isa_ros.fieldbus.ethercat.interface import open_interface
        open_interface(request.interface).close()
