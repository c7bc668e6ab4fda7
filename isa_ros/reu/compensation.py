"""
Nonlinear compensation of a block's demand for the valve's flow curve.

For a dual-gain curve, the paper's block DGC, and for the dead band of a valve with overlap. Its
demand and output have the unit of the spool (m) or of the series current (A), whichever the block
commands.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, Parameters, tunable
from isa_ros.core.record import record
import numpy as np


@frozen(kw_only=True)
class Linear(Parameters):
    """No compensation."""


@frozen(kw_only=True)
class DualGain(Parameters):
    """Inverse of the valve's dual-gain flow curve."""

    knee: float = tunable('end of the low-gain region', 'm | A', gt=0.0, le=1.0)
    slope: float = tunable('low gain over high gain', '1', gt=0.0, le=1.0)
    applies_to: str = choice(
        'its input: the whole demand (our reading), or the velocity compensation alone '
        "(the paper's text)", 'demand', 'velocity')


@frozen(kw_only=True)
class DeadBand(Parameters):
    """Continuous inverse of a dead band: the overlap is added to every demand but small ones."""

    overlap: float = tunable('of the valve, from null to the first flow', 'm | A', gt=0.0, le=1.0)
    transition: float = tunable(
        'demand from which on the whole overlap is added; below it in proportion', 'm | A',
        gt=0.0, le=1.0)
    slope: float = tunable(
        'output over demand beyond that; 1 - overlap/limit keeps the full output', '1',
        gt=0.0, le=1.0)


COMPENSATION = np.dtype([
    ('knee', 'f8'), ('slope', 'f8'), ('of_velocity', 'f8'),
    ('overlap', 'f8'), ('transition', 'f8')])   # overlap 0: no dead band
_NO_KNEE = 1e300  # any unit: a demand never reaches it


def compensation_record(sheet: Linear | DualGain | DeadBand) -> np.record:
    """Return the `COMPENSATION` record of a sheet."""
    knee, slope, of_velocity, overlap, transition = _NO_KNEE, 1.0, False, 0.0, 1.0
    if isinstance(sheet, DualGain):
        knee, slope, of_velocity = sheet.knee, sheet.slope, sheet.applies_to == 'velocity'
    elif isinstance(sheet, DeadBand):
        slope, overlap, transition = sheet.slope, sheet.overlap, sheet.transition
    return record(COMPENSATION, knee=knee, slope=slope, of_velocity=float(of_velocity),
                  overlap=overlap, transition=transition)


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


@kernel
def dead_band_compensation(demand, compensation):
    """
    Return s u + d max(-1, min(1, u/e))  (R21), in the demand's unit.

    d is the overlap, e > 0 the transition, s the slope: the flow beyond the overlap is
    proportional to a demand beyond e. Within e the gain is s + d/e, finite, so that noise of the
    demand does not throw the spool from one side of the band to the other.
    """
    share = max(-1.0, min(1.0, demand / compensation.transition))
    return compensation.slope * demand + compensation.overlap * share


@kernel
def demand_over_dead_band(output, compensation):
    """Return the demand whose `dead_band_compensation` is ``output``  (R21), in its unit."""
    overlap, transition = compensation.overlap, compensation.transition
    if abs(output) <= compensation.slope * transition + overlap:
        return output / (compensation.slope + overlap / transition)
    return (output - (overlap if output > 0.0 else -overlap)) / compensation.slope


@kernel
def compensated(demand, compensation):
    """Return the output of a demand  (R4, R21), in its unit."""
    if compensation.overlap > 0.0:
        return dead_band_compensation(demand, compensation)
    return dual_gain_compensation(demand, compensation)


@kernel
def demand_for(output, compensation):
    """Return the demand whose `compensated` is ``output``  (R4, R21), in its unit."""
    if compensation.overlap > 0.0:
        return demand_over_dead_band(output, compensation)
    return flow_curve(output, compensation)
