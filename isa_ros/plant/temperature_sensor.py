"""
The sensor of the oil's temperature, read once a tick, at its end.

    y(t) = theta(t) + bias + drift t + sigma n(t), rounded to whole steps  (S4)

n is white and normal, of `isa_ros.core.noise`, behind the channels of the other sensors. A stuck
sensor keeps its reading. Neglected: its delay, for the oil takes seconds to get warm.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.noise import normal
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ParameterError
from isa_ros.plant.channels import TEMPERATURE_NOISE
import numpy as np

_IDEAL = 'assumed, ideal'


@frozen(kw_only=True)
class TemperatureSensor(Parameters):
    """Resolution and errors of the temperature sensor."""

    resolution: float = parameter(
        'step of the readings; 0: none', 'K', absent=0.0, source=_IDEAL, ge=0.0, le=10.0)
    sigma: float = parameter(
        'white noise of a reading, standard deviation', 'K', absent=0.0, source=_IDEAL,
        changeable=True, ge=0.0, le=100.0)
    bias: float = parameter(
        'constant error', 'K', absent=0.0, source=_IDEAL, changeable=True, ge=-200.0, le=200.0)
    drift_per_s: float = parameter(
        'growth of the error', 'K/s', absent=0.0, source=_IDEAL, changeable=True, ge=-10.0,
        le=10.0)
    stuck: float = parameter(
        '1: the reading stays as it is', '1', absent=0.0, source=_IDEAL, changeable=True,
        ge=0.0, le=1.0)

    def __post_init__(self) -> None:
        """Refuse a sensor that is stuck by a part."""
        super().__post_init__()
        if self.stuck not in (0.0, 1.0):
            raise ParameterError(f'stuck = {self.stuck:g}, must be 0 or 1')


TEMPERATURE_SENSOR = np.dtype([
    ('resolution', 'f8'), ('sigma', 'f8'), ('bias', 'f8'),      # K
    ('drift', 'f8'),                                            # K/s
    ('is_stuck', 'i8')])


def temperature_sensor_record(sheet: TemperatureSensor) -> np.record:
    """Return the `TEMPERATURE_SENSOR` record of a sheet."""
    return record(
        TEMPERATURE_SENSOR, resolution=sheet.resolution, sigma=sheet.sigma, bias=sheet.bias,
        drift=sheet.drift_per_s, is_stuck=int(sheet.stuck))


@kernel
def read_temperature(step, temperature, key, own, before):
    """
    Return the reading at plant step ``step``  (S4), in celsius.

    ``before`` is the last one, of which there is none at step 0; ``key`` that of the noise. The
    resolution is > 0 where it divides.
    """
    if own.is_stuck == 1 and step > 0:
        return before
    value = temperature + own.bias + own.drift * (step * PLANT_STEP)
    if own.sigma != 0.0:
        value += own.sigma * normal(key, step, TEMPERATURE_NOISE)
    if own.resolution > 0.0:
        value = np.floor(value / own.resolution + 0.5) * own.resolution
    return value
