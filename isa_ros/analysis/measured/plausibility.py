"""
Signs of a wrong unit in a mapping, each a line for the user before a search that takes minutes.

Nothing is refused by them: a measurement may be as fast or as short, and a machine be so far from
its configuration.
"""

from collections.abc import Iterator, Mapping
import math

from isa_ros.actuator.setpoint_range import Bounds
from isa_ros.analysis.measured.fit import Fit
from isa_ros.analysis.measured.mapping import MeasurementMapping, PLACE
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.quantities import QUANTITIES, units_of
from isa_ros.core.units import of_coordinate
from isa_ros.text.table import digits
import numpy as np

_SLOWEST, _FASTEST = 5.0, 2e4   # Hz, of the usual loggers of a hydraulic machine
_ROUNDED = 1e-6                 # of a step
_SHORTEST = 0.1                 # s
_WINDOW = 0.01                  # s, over which a speed is taken: sensors are noisy
_MOST_OF_TIME = 0.99            # samples beyond the speed of this share may be a sensor's
_TOO_FAST = 3.0                 # rated speeds
_FAR = 7.0                      # gain, or its inverse: MPa and bar are 10 apart, bar and psi 14.5
_ALIKE = 1.5                    # left over gain, up to which courses are alike: r >= 0.55
_MOSTLY = 0.5                   # of a command's samples
_FARTHER = 30.0                 # times as far as commanded
_NEAR = 3.0                     # gain over the ratio of two units, or its inverse


def doubts_of_time(measurement: Measurement, mapping: MeasurementMapping) -> Iterator[str]:
    """Yield a doubt in the unit of the time: samples too fast, too slow or too short."""
    t = measurement.times
    if len(t) < 2:
        return
    step, span = float(np.median(np.diff(t))), float(t[-1] - t[0])
    if _is_usual(step) and span >= _SHORTEST:
        return
    rate = digits(1.0 / step, 3)
    said = f'{measurement.name}: {rate} samples per second for {digits(span, 3)} s'
    if mapping.rate:
        yield f'{said}: is rate_hz right?'
    elif mapping.time is not None:
        yield f'{said}: is its time in {_other_time(step, mapping.time_scale)}?'


def _other_time(step: float, scale: float) -> str:
    """Return the units of time by which a step would be a usual one, or that it is another."""
    known = {'s': 1.0, 'ms': 1e-3, 'us': 1e-6}
    return ' or '.join(name for name, one in known.items() if one != scale and _is_usual(
        step / scale * one)) or 'another unit'


def _is_usual(step: float) -> bool:
    """Return whether a step of the time, s, is that of a usual logger."""
    return 1.0 / _FASTEST <= step * (1.0 + _ROUNDED) and step * (1.0 - _ROUNDED) <= 1.0 / _SLOWEST


def doubts_of_speed(
        measurement: Measurement, duration: float, rated: float, unit: str) -> Iterator[str]:
    """
    Yield a doubt in the units of position and time: it moves too fast; ``unit`` of speeds.

    Looked at is what is compared, so many s.
    """
    own = measurement.outputs.get('position')
    if own is None or min(own.t[-1], duration) - own.t[0] < 2.0 * _WINDOW:
        return
    t = np.arange(own.t[0], min(own.t[-1], duration), _WINDOW)
    moved = np.diff(np.interp(t, own.t, own.values))
    speed = float(np.quantile(np.abs(moved), _MOST_OF_TIME)) / _WINDOW
    if speed > _TOO_FAST * rated:
        yield (f'{measurement.name}: the position moves at {digits(speed, 3)} {unit}, the rated '
               f'speed is {digits(rated, 3)} {unit}: are the units of position and time right?')


def doubts_of_commands(
        measurement: Measurement, bounds: Mapping[str, Bounds]) -> Iterator[str]:
    """Yield a doubt in the unit of each command that is mostly beyond its range, or of another."""
    for name, own in measurement.commands.items():
        range_ = bounds.get(QUANTITIES[name].setpoint)
        if range_ is None:
            continue
        beyond = float(np.mean((own.values < range_.low) | (own.values > range_.high)))
        if beyond > _MOSTLY:
            yield (f'{measurement.name}: {digits(100.0 * beyond, 3)} % of {name} are beyond '
                   f'{range_.low:g} to {range_.high:g} {range_.unit}, {range_.what}: is its unit '
                   'right?')
    place, command = measurement.outputs.get('position'), measurement.commands.get(PLACE)
    if place is not None and command is not None:
        moved, wanted = (float(np.ptp(own.values)) for own in (place, command))
        if moved > _FARTHER * wanted > 0.0:
            yield (f'{measurement.name}: the position moves {digits(moved / wanted, 3)} times as '
                   f'far as {PLACE}: are both units right?')


def doubts_of_fits(
        fits: Mapping[str, Fit | str], mapping: MeasurementMapping, is_rotary: bool
        ) -> Iterator[str]:
    """Yield a doubt in the unit of each signal that is simulated as many times as large."""
    for quantity, found in fits.items():
        if isinstance(found, str) or found.is_at_end or not found.gain > 0.0:
            continue
        if 1.0 / _FAR <= found.gain <= _FAR or found.left > _ALIKE * found.gain:
            continue
        likely = _other_unit(quantity, mapping.signals[quantity].unit, found.gain, is_rotary)
        yield (f'{mapping.name}: signals.{quantity}: what is simulated is {digits(found.gain, 3)} '
               f'times what is measured: is its unit {likely}?')


def _other_unit(quantity: str, unit: str, gain: float, is_rotary: bool) -> str:
    """Return the unit of a quantity that would make a gain about 1, or that it is another."""
    known = units_of(of_coordinate(QUANTITIES[quantity].unit, is_rotary))

    def distance(name: str) -> float:
        return abs(math.log(known[name] / known[unit] / gain))
    nearest = min(known, key=distance)
    return f'{nearest}, not {unit}' if distance(nearest) < math.log(_NEAR) else 'or scale another'
