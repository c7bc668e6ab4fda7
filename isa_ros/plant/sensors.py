"""
Sensors of the REU: 12-bit converters and the encoder.

All measurements that the controller uses pass through them.
"""

from dataclasses import dataclass
import math

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ParameterError
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Sensors(Parameters):
    """Ranges and resolutions."""

    adc_bits: float = parameter('resolution of the converters', 'bit', ge=4, le=24)
    encoder_resolution: float = parameter('position resolution', 'm | rad', gt=0.0, le=0.01)
    force_range: float = parameter('force sensor, +-', 'N | Nm', gt=0.0, le=1e6)
    pressure_range_mpa: float = parameter('pressure sensors, 0 to', 'MPa', gt=0.0, le=100.0)
    spool_range_mm: float = parameter('spool sensor, +-', 'mm', gt=0.0, le=2.0)
    current_range_ma: float = parameter('current sensor, +-', 'mA', gt=0.0, le=200.0)

    def __post_init__(self) -> None:
        """Refuse a resolution that is not a whole number of bits."""
        super().__post_init__()
        if self.adc_bits != int(self.adc_bits):
            raise ParameterError(f'adc_bits = {self.adc_bits:g} bit, must be a whole number')


SENSORS = np.dtype([
    ('encoder', 'f8'),
    ('force_range', 'f8'), ('force_step', 'f8'),
    ('pressure_range', 'f8'), ('pressure_step', 'f8'),
    ('spool_range', 'f8'), ('spool_step', 'f8'),
    ('current_range', 'f8'), ('current_step', 'f8')])


def sensors_record(sheet: Sensors) -> np.record:
    """Return the `SENSORS` record: a range and a step of one least significant bit each."""
    codes = float(1 << int(sheet.adc_bits))
    pressure = sheet.pressure_range_mpa * MPA
    spool, current = sheet.spool_range_mm * MILLI, sheet.current_range_ma * MILLI
    return record(
        SENSORS, encoder=sheet.encoder_resolution,
        force_range=sheet.force_range, force_step=2.0 * sheet.force_range / codes,
        pressure_range=pressure, pressure_step=pressure / codes,
        spool_range=spool, spool_step=2.0 * spool / codes,
        current_range=current, current_step=2.0 * current / codes)


@kernel
def encode(position, resolution):
    """Return the position rounded to whole encoder counts  (S1)."""
    return math.floor(position / resolution + 0.5) * resolution


@kernel
def convert(value, lowest, highest, step):
    """Return the nearest code of a converter with full scale ``lowest`` to ``highest``  (S2)."""
    clipped = max(lowest, min(highest - step, value))
    return lowest + math.floor((clipped - lowest) / step + 0.5) * step
