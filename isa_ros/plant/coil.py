"""
Coil current behind the closed current loop of the amplifier.

Equation 10 of the paper IS the closed current loop: never nest it in another one. Currents
are the amplifier's, in A: two redundant coils in parallel each carry half of it, so the
valve curves' series scale is half of the amplifier's. Positive current extends.

Neglected by this default: the 1.8 kHz mode and the sampling of the current loop.
"""

from dataclasses import dataclass

from isa_ros.kernel import kernel
from isa_ros.parameter import parameter, Parameters
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Coil(Parameters):
    """The amplifier and its two coils in parallel."""

    bandwidth_rad_per_s: float = parameter(
        'pole p_c of the closed current loop (eq 10)', 'rad/s', gt=0.0, le=5.0e4)
    supply_voltage: float = parameter('amplifier saturation', 'V', gt=0.0, le=100.0)
    resistance: float = parameter('coil resistance', 'ohm', gt=0.0, le=1.0e5)
    inductance: float = parameter('coil inductance', 'H', gt=0.0, le=100.0)
    parallel_coils: float = parameter(
        'amplifier current per series-scale current', '1', ge=1.0, le=2.0)


COIL = np.dtype([
    ('p_c', 'f8'), ('voltage', 'f8'), ('resistance', 'f8'), ('inductance', 'f8'),
    ('parallel', 'f8')])
COIL_STATE = np.dtype([('current', 'f8')])


def coil_record(sheet: Coil) -> tuple[float, ...]:
    """Return the `COIL` record of a sheet."""
    return (sheet.bandwidth_rad_per_s, sheet.supply_voltage, sheet.resistance, sheet.inductance,
            sheet.parallel_coils)


@kernel
def current_rate(current, reference, coil):
    """
    Return di/dt = p_c (i_r - i), bounded by (+-U - R i)/L  (V1), in A/s.

    Equation 10 of the paper with the voltage limit of the amplifier.
    """
    highest = (coil.voltage - coil.resistance * current) / coil.inductance
    lowest = (-coil.voltage - coil.resistance * current) / coil.inductance
    return max(lowest, min(highest, coil.p_c * (reference - current)))
