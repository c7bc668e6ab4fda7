"""
Largest gains that a loop can use: those with which one count of a sensor demands its whole output.

With K_p > u_max / q, where u_max is the block's limit and q the smallest step of its measured
value, a single count saturates the demand: the loop is a relay. The same holds for K_i after one
period. Gains on speeds have no such bound, since speeds are filtered.
"""

from collections.abc import Mapping

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.plant.sensors import sensors_record
from isa_ros.reu.block import Pid
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.wiring import VARIABLES

_STEPS = {'position': 'encoder', 'force': 'force_step', 'pressure': 'pressure_step',
          'spool': 'spool_step'}
"""Field of `SENSORS` with the smallest step of each measured variable."""

REASON = 'with more, one count of its sensor demands the whole output'


def largest_gains(sheet: ActuatorSheet) -> Mapping[str, float]:
    """Return the largest usable gains in the units of the sheet, as ``force.kp``."""
    sensors = sensors_record(sheet.plant.sensors)
    found: dict[str, float] = {}
    for variable in VARIABLES:
        block = getattr(sheet.reu, variable)
        if isinstance(block, Pid):
            kp, period = block.limit / sensors[_STEPS[variable]], 1.0 / block.rate_hz
            gains = {'kp': kp, 'ki': kp / period}
        elif isinstance(block, Impedance):
            stiffness = max(block.force_out, block.force_in) / sensors[_STEPS[variable]]
            gains = {'stiffness': stiffness}
        else:
            continue
        found |= {f'{variable}.{name}': float(gain) for name, gain in gains.items()}
    return found
