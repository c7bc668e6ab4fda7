"""
Nonlinear compensation of a block's demand for the valve's dual-gain flow curve.

The paper's block DGC. Its demand and output have the unit of the spool (m) or of the series
current (A), whichever the block commands.
"""

from dataclasses import dataclass

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, Parameters, tunable
from isa_ros.core.record import record
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Linear(Parameters):
    """No compensation."""


@dataclass(frozen=True, kw_only=True)
class DualGain(Parameters):
    """Inverse of the valve's dual-gain flow curve."""

    knee: float = tunable('end of the low-gain region', 'm | A', gt=0.0, le=1.0)
    slope: float = tunable('low gain over high gain', '1', gt=0.0, le=1.0)
    applies_to: str = choice(
        'its input: the whole demand (our reading), or the velocity compensation alone '
        "(the paper's text)", 'demand', 'velocity')


COMPENSATION = np.dtype([('knee', 'f8'), ('slope', 'f8'), ('of_velocity', 'f8')])
_NO_KNEE = 1e300  # any unit: a demand never reaches it


def compensation_record(sheet: Linear | DualGain) -> np.record:
    """Return the `COMPENSATION` record of a sheet."""
    if isinstance(sheet, DualGain):
        return record(COMPENSATION, knee=sheet.knee, slope=sheet.slope,
                      of_velocity=float(sheet.applies_to == 'velocity'))
    return record(COMPENSATION, knee=_NO_KNEE, slope=1.0, of_velocity=0.0)


@kernel
def dual_gain_compensation(demand, compensation):
    """
    Return the continuous inverse of the flow curve  (R4), in the demand's unit.

    |u| is unchanged up to the knee and has the slope ``slope`` beyond it, so that the flow is
    proportional to the demand. In our reading its input is the whole demand (errata 23).
    """
    knee = compensation.knee
    if demand > knee:
        return knee + compensation.slope * (demand - knee)
    if demand < -knee:
        return -knee + compensation.slope * (demand + knee)
    return demand


@kernel
def flow_curve(output, compensation):
    """Return the demand whose `dual_gain_compensation` is ``output``  (R4), in its unit."""
    knee = compensation.knee
    if output > knee:
        return knee + (output - knee) / compensation.slope
    if output < -knee:
        return -knee + (output + knee) / compensation.slope
    return output
