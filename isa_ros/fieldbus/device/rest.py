"""Whether the load of an REU that holds after its quick stop is at rest, as the drive sees it."""

from isa_ros.core.device import QUICK_STOP
from isa_ros.core.units import MILLI
from isa_ros.fieldbus.device.axis import Axis
from isa_ros.reu.device_record import STAYS
from isa_ros.reu.flow_stop import REST_SPAN, REST_TIME
from isa_ros.tick.emergency_stop import LONGEST_STOP


class Rest:
    """
    Watches the position of an axis over the quick stop of its REU.

    An REU with `quick_stop: ramp_and_hold` does not end its stop by itself; where an option code
    of the drive ends it, the drive does, by the rule of the REU (R16).
    """

    def __init__(self, axis: Axis) -> None:
        device = axis.sheet.reu.device
        self._axis = axis
        self._is_needed = device.quick_stop == STAYS
        self._span = REST_SPAN * axis.stroke
        hold = max(REST_TIME, device.quick_stop_hold_ms * MILLI)
        self._hold, self._longest = round(hold / axis.step), round(LONGEST_STOP / axis.step)
        self._lowest = self._highest = 0.0
        self._lasted = self._stood = 0      # ticks

    def watch(self) -> None:
        """Follow a sample."""
        axis = self._axis
        if axis.state != QUICK_STOP:
            self._lasted = self._stood = 0
            self._lowest = self._highest = axis.position
            return
        self._lasted += 1
        self._stood += 1
        self._lowest = min(self._lowest, axis.position)
        self._highest = max(self._highest, axis.position)
        if self._highest - self._lowest > self._span:
            self._lowest = self._highest = axis.position
            self._stood = 0

    @property
    def is_over(self) -> bool:
        """Return whether the load has stood for the hold of the REU, or has had time enough."""
        return self._is_needed and (
            self._stood >= self._hold or self._lasted >= self._longest)
