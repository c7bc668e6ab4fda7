"""
Channels of the sensors: what stands between a quantity and the converter that reads it.

At each conversion the exact value x of every channel passes  (S3)

    x_d(t) = x(t - delay)                     a delay of whole conversions
    y(t) = scale x_d(t) + bias + drift (t - t_0) + sigma n(t)

and y is what encoder or converter reads; a scale of -1 is swapped wires, or a reversed encoder.
A channel with a converter that is lost, its wire broken, reads `DEAD` of its range below zero,
where a live zero shows it. n is white and normal, of `isa_ros.core.noise`; t_0 is
the first conversion of the run, or that at which the channels were no longer ideal. A stuck
channel keeps its reading; if it is stuck at the first conversion, that one is kept.

The last channel is that of the supply's pressure, which has a transmitter of its own and no step.
"""

from collections.abc import Mapping
from typing import Any

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.noise import normal
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.signals import CHANNELS, SUPPLY_CHANNEL
from isa_ros.core.timebase import PLANT_STEP, PLANT_STEP_NS
from isa_ros.core.units import MILLI
from isa_ros.errors import ParameterError
import numpy as np

NAMES = (*CHANNELS, SUPPLY_CHANNEL)
N_CHANNELS = len(NAMES)
SUPPLY = NAMES.index(SUPPLY_CHANNEL)
TEMPERATURE_NOISE, SUPPLY_NOISE = len(CHANNELS), len(CHANNELS) + 1    # channels of the noise
LINE = 128  # conversions that a delay line holds
DEAD = 0.25     # of a range: 0 mA where 4 to 20 mA are the range
_MS_PER_STEP = PLANT_STEP_NS * 1e-6
_IDEAL = 'assumed, ideal'


def _sigma(unit: str, largest: float) -> Any:
    return parameter('white noise of a conversion, standard deviation', unit, absent=0.0,
                     source=_IDEAL, changeable=True, ge=0.0, le=largest)


def _bias(unit: str, largest: float) -> Any:
    return parameter('constant error', unit, absent=0.0, source=_IDEAL, changeable=True,
                     ge=-largest, le=largest)


def _drift(unit: str, largest: float) -> Any:
    return parameter('growth of the error', unit, absent=0.0, source=_IDEAL,
                     changeable=True, ge=-largest, le=largest)


@frozen(kw_only=True)
class Channel(Parameters):
    """Errors of any channel."""

    delay_ms: float = parameter(
        'age of what is read, whole conversions', 'ms', absent=0.0, source=_IDEAL,
        changeable=True, ge=0.0, le=1e3)
    stuck: float = parameter(
        '1: the reading stays as it is', '1', absent=0.0, source=_IDEAL, changeable=True,
        ge=0.0, le=1.0)
    scale: float = parameter(
        'what is read over what is there', '1', absent=1.0, source=_IDEAL, changeable=True,
        ge=-2.0, le=2.0)

    def __post_init__(self) -> None:
        """Refuse a channel that is stuck by a part."""
        super().__post_init__()
        if self.stuck not in (0.0, 1.0):
            raise ParameterError(f'stuck = {self.stuck:g}, must be 0 or 1')


@frozen(kw_only=True)
class ConvertedChannel(Channel):
    """Errors of a channel with a converter."""

    lost: float = parameter(
        '1: the wire is broken', '1', absent=0.0, source=_IDEAL, changeable=True, ge=0.0,
        le=1.0)

    def __post_init__(self) -> None:
        """Refuse a wire that is broken by a part."""
        super().__post_init__()
        if self.lost not in (0.0, 1.0):
            raise ParameterError(f'lost = {self.lost:g}, must be 0 or 1')


@frozen(kw_only=True)
class PositionChannel(Channel):
    """Errors of the encoder."""

    sigma: float = _sigma('m | rad', 0.01)
    bias: float = _bias('m | rad', 0.1)
    drift_per_s: float = _drift('m/s | rad/s', 0.1)


@frozen(kw_only=True)
class ForceChannel(ConvertedChannel):
    """Errors of the load cell or torque sensor."""

    sigma: float = _sigma('N | Nm', 1e6)
    bias: float = _bias('N | Nm', 1e7)
    drift_per_s: float = _drift('N/s | Nm/s', 1e7)


@frozen(kw_only=True)
class PressureChannel(ConvertedChannel):
    """Errors of a pressure sensor."""

    sigma: float = _sigma('Pa', 1e7)
    bias: float = _bias('Pa', 1e8)
    drift_per_s: float = _drift('Pa/s', 1e8)


@frozen(kw_only=True)
class SpoolChannel(ConvertedChannel):
    """Errors of the spool sensor."""

    sigma: float = _sigma('m', 1e-4)
    bias: float = _bias('m', 2e-3)
    drift_per_s: float = _drift('m/s', 2e-3)


@frozen(kw_only=True)
class CurrentChannel(ConvertedChannel):
    """Errors of the current sensor, in A of the amplifier."""

    sigma: float = _sigma('A', 0.01)
    bias: float = _bias('A', 0.2)
    drift_per_s: float = _drift('A/s', 0.2)


CHANNEL_ERRORS = np.dtype([
    ('are_ideal', 'i8'),                        # 1: no channel has an error
    ('sigma', 'f8', (N_CHANNELS,)),             # SI
    ('bias', 'f8', (N_CHANNELS,)),
    ('drift', 'f8', (N_CHANNELS,)),             # per second
    ('delay_steps', 'i8', (N_CHANNELS,)),       # plant steps
    ('is_stuck', 'i8', (N_CHANNELS,)),
    ('scale', 'f8', (N_CHANNELS,)),
    ('is_lost', 'i8', (N_CHANNELS,)),
])
CHANNELS_STATE = np.dtype([
    ('step', 'i8'),                             # plant step of the last conversion
    ('beginning', 'i8'),                        # and that of t_0
    ('filled', 'i8'),                           # conversions in the delay line
    ('slot', 'i8'),                             # place of the last one, modulo LINE
    ('line', 'f8', (LINE, N_CHANNELS)),         # exact values
    ('shown', 'f8', (N_CHANNELS,)),             # to the converters
])
"""The delay line of one actuator, and its last values."""


def channel_errors(channels: Mapping[str, Any]) -> np.record:
    """Return the `CHANNEL_ERRORS` of the channels by name."""
    ordered = [channels[name] for name in NAMES]
    steps = [round(channel.delay_ms / _MS_PER_STEP) for channel in ordered]
    errors = {
        'sigma': [channel.sigma for channel in ordered],
        'bias': [channel.bias for channel in ordered],
        'drift': [channel.drift_per_s for channel in ordered],
        'delay_steps': steps, 'is_stuck': [int(channel.stuck) for channel in ordered],
        'is_lost': [int(getattr(channel, 'lost', 0.0)) for channel in ordered]}
    scale = [channel.scale for channel in ordered]
    is_ideal = not any(any(values) for values in errors.values()) and set(scale) == {1.0}
    return record(CHANNEL_ERRORS, are_ideal=is_ideal, scale=scale, **errors)


def longest_delay_ms(period_steps: int) -> float:
    """Return the longest delay in ms, with a conversion every ``period_steps`` plant steps."""
    return (LINE - 1) * period_steps * _MS_PER_STEP


def refuse_delays(channels: Mapping[str, Any], period_steps: int) -> None:
    """
    Refuse delays that are not whole conversions, or longer than the delay line.

    ``period_steps`` is the period of the converters in plant steps.

    Raises
    ------
    ParameterError
        A delay is refused.

    """
    period_ms, longest = period_steps * _MS_PER_STEP, longest_delay_ms(period_steps)
    for name in NAMES:
        delay = channels[name].delay_ms
        conversions = delay / period_ms
        if delay > longest or abs(conversions - round(conversions)) > MILLI:
            raise ParameterError(
                f'plant.sensors.{name}.delay_ms = {delay:g} ms, must be <= {longest:g} ms and a '
                f'multiple of {period_ms:g} ms, the period of the converters '
                '(reu.current.rate_hz)')


@kernel
def enter(step, period, state):
    """
    Return the place in the delay line for the exact values of the conversion at ``step``.

    After a gap of more than a ``period`` the line is empty before, and t_0 is now.
    """
    if state.filled == 0 or step - state.step > period:
        state.filled, state.beginning = 0, step
    if state.filled == 0 or step > state.step:
        state.slot += 1
        state.filled = min(state.filled + 1, LINE)
    state.step = step
    return state.line[state.slot % LINE]


@kernel
def disturb(step, period, key, errors, state):
    """
    Write into ``shown`` what the channels show their converters at plant step ``step``  (S3).

    ``key`` of the noise. A delay line that is not yet full shows its oldest value.
    """
    for k in range(N_CHANNELS):
        if errors.is_stuck[k] == 1 and state.filled > 1:
            continue
        age = min(errors.delay_steps[k] // period, state.filled - 1)
        value = errors.scale[k] * state.line[(state.slot - age) % LINE, k] + errors.bias[k]
        if errors.drift[k] != 0.0:
            value += errors.drift[k] * ((step - state.beginning) * PLANT_STEP)
        if errors.sigma[k] != 0.0:
            value += errors.sigma[k] * normal(key, step, k if k < SUPPLY else SUPPLY_NOISE)
        state.shown[k] = value
