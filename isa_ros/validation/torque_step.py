"""
The blocked torque step of figure 13 by every definition of its rise, and its bandwidths.

The paper prints "a rise time of approximately 8 ms" and "50 Hz to 100 Hz" without saying which
rise and which bandwidth; so all three rises, and both bandwidths, are measured and compared.
"""

from isa_ros.analysis.response.bode import bode
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.response.step import step
from isa_ros.analysis.response.sweep import FrequencySweep
from isa_ros.analysis.signals.frequency import Response
from isa_ros.core.frozen import frozen
import numpy as np

STEP_S = 0.2
SWEEP = FrequencySweep(low=5.0, high=200.0, points=30)
QUARTER = -90.0     # deg
LEVELS = {'10_90': (0.1, 0.9), '0_90': (0.0, 0.9), '0_100': (0.0, 1.0)}


@frozen
class TorqueStep:
    """A step of 10 % of the rating, blocked; NaN for what is not reached."""

    rise: dict[str, float]
    """Rise by the names of `LEVELS`, s."""
    overshoot: float
    """Percent."""
    steady_error: float
    """Nm or N."""
    settling: float
    """Into 5 %, s."""
    ripple: float
    """Nm or N."""


def measured_step(bench: Rig, amplitude: float) -> TorqueStep:
    """Return the figures of a step of a force loop by ``amplitude``, from 100 us samples."""
    found = step(bench, STEP_S, amplitude)
    after = found.t >= 0.0
    share = found.output[after] / amplitude
    crossed = {level: crossing(found.t[after], share, level) for level in (0.1, 0.9, 1.0)}
    crossed[0.0] = 0.0
    settled = found.figures.settling_time
    return TorqueStep(
        {name: crossed[high] - crossed[low] for name, (low, high) in LEVELS.items()},
        100.0 * found.figures.overshoot, found.figures.steady_error,
        float('nan') if settled is None else settled, found.figures.ripple)


def crossing(t: np.ndarray, y: np.ndarray, level: float) -> float:
    """Return the time at which ``y`` first reaches a level, interpolated; NaN if it never does."""
    above = np.flatnonzero(y >= level)
    if not len(above):
        return float('nan')
    k = int(above[0])
    return float(t[0] if k == 0 else np.interp(level, y[k - 1:k + 1], t[k - 1:k + 1]))


def bandwidths(bench: Rig, amplitude: float | None = None) -> tuple[float, float]:
    """Return the frequencies of -3 dB and of -90 deg of a closed loop, Hz; NaN: not in 5-200."""
    found = bode(bench, SWEEP, 'closed', amplitude)
    return (float('nan') if found.bandwidth is None else found.bandwidth,
            quarter_turn(found.response))


def quarter_turn(response: Response) -> float:
    """Return the frequency at which the phase first falls to -90 deg, Hz; NaN if it does not."""
    return float(10.0 ** crossing(np.log10(response.frequency), -response.phase, -QUARTER))
