"""The line of a request: what its bus has under the names that `isa_ros.fieldbus.request` says."""

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.request import BUSES, BusRequest
from isa_ros.fieldbus.session import OpenLine


def line_of(request: BusRequest) -> OpenLine:
    """Return what opens the line of a request; it raises `ConfigError` where it cannot."""
    open_line = getattr(_module(request), f'{request.bus}_line')
    return lambda devices, step_ns: open_line(devices, step_ns=step_ns, **request.arguments)


def refuse_unusable(request: BusRequest, devices: Sequence[BusDevice], step_ns: int) -> str:
    """
    Refuse a line that cannot be opened or is too slow, before kernels are compiled for it.

    Nothing is sent on it. Return a line for the user, '' for none.

    Raises
    ------
    ConfigError
        The interface does not exist, is down, or needs a permission or a package; or the frames
        of a tick do not fit.

    """
    said: str | None = _module(request).refuse_unusable(
        devices, step_ns=step_ns, **request.arguments)
    return said or ''


def _module(request: BusRequest) -> Any:
    return import_module(f'isa_ros.fieldbus.{BUSES[request.bus].module}')
