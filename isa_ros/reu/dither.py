"""
Dither: a square wave on the reference of the current, which keeps the spool moving.

It takes the play of friction and hysteresis out of a valve whose data sheet states them without
dither. It changes at conversions of the current block, and is off where the outputs are off; the
references that are recorded are without it, the measured current has it.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.errors import ParameterError

_LOWEST = 1e-3      # Hz
_ROUNDED = 5e-3     # of a frequency that is printed with three digits


@frozen(kw_only=True)
class Dithered(Parameters):
    """Dither of a current block."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    dither_percent: float = parameter(
        "amplitude of a square wave on the reference, of the current at the spool's stop", '%',
        absent=0.0, source='assumed, none', ge=0.0, le=20.0)
    dither_hz: float = parameter(
        'its frequency', 'Hz', absent=0.0, source='assumed, none', ge=0.0, le=25e3)

    def __post_init__(self) -> None:
        """Refuse a dither whose half period is no whole number of the block's periods."""
        super().__post_init__()
        if 0.0 < self.dither_hz < _LOWEST:
            raise ParameterError(
                f'dither_hz = {self.dither_hz:g} Hz, must be 0 Hz or >= {_LOWEST:g} Hz')
        if self.dither_percent == 0.0:
            return
        if self.dither_hz == 0.0:
            raise ParameterError(
                f'dither_percent = {self.dither_percent:g} %, must be 0 % with dither_hz = 0 Hz')
        exact = 0.5 * self.rate_hz / self.dither_hz
        n = self.half_period
        if abs(exact - n) > _ROUNDED * exact:
            near = sorted({0.5 * self.rate_hz / k for k in (n, n + 1, max(1, n - 1))})
            raise ParameterError(
                f'dither_hz = {self.dither_hz:g} Hz, half of its period must be a whole number of '
                f'periods of rate_hz = {self.rate_hz:g} Hz, such as '
                f'{" or ".join(f"{hz:.4g}" for hz in near)} Hz')

    @property
    def half_period(self) -> int:
        """Return half of the period of the dither in periods of the block; 1 without one."""
        return max(1, round(0.5 * self.rate_hz / self.dither_hz)) if self.dither_hz > 0.0 else 1


@frozen(kw_only=True)
class HeldWithDither(Dithered):
    """The block samples and holds its reference; its loop is closed in the plant's equations."""

    KIND = 'held'


@kernel
def dither(step, offset, half, amplitude):
    """
    Return A (-1)^floor((k - k_0)/n) at plant step k, in A  (R20).

    ``half`` is n, half of the period in plant steps, ``offset`` k_0 that of the conversions.
    """
    return amplitude if (step - offset) // half % 2 == 0 else -amplitude
