"""The times of a run on its grid: macro steps of whole windows of plant steps, and ticks."""

from typing import Any, NamedTuple

from isa_ros.config.text.keys import InText, Key, nanoseconds, number, Value
from isa_ros.config.text.sections import Place
from isa_ros.core.timebase import FORCE_WINDOWS, PLANT_STEP_NS
from isa_ros.errors import ConfigError

_TICK_GRID_NS = FORCE_WINDOWS * PLANT_STEP_NS
LATEST_START_S = 2_000_000_000
"""Of a run, since 1970: 147,483,647 s before the seconds of a stamp, 32 bits, end."""


class WrittenTime(NamedTuple):
    """A time as a file has it."""

    key: str
    value: float
    unit: str
    in_ns: int
    """The unit in ns."""

    @property
    def ns(self) -> int:
        """Return the nearest whole number of ns."""
        return round(self.value * self.in_ns)

    def is_multiple_of(self, period_ns: int) -> bool:
        """Return whether the time is a whole number of periods."""
        return self.ns % period_ns == 0 and abs(self.ns - self.value * self.in_ns) <= 1e-3

    def words(self, ns: float) -> str:
        """Return a time in the unit of this one."""
        return f'{ns / self.in_ns:.15g} {self.unit}'

    def __str__(self) -> str:
        return f'{self.key} = {self.value:.15g} {self.unit}'


def on_grid(step: WrittenTime, offset: WrittenTime, place: Place) -> tuple[int, int]:
    """
    Return macro step and offset of the REU's samples, ns.

    Raises
    ------
    ConfigError
        They are not whole numbers of plant steps, or the offset is not within a macro step.

    """
    if not step.is_multiple_of(_TICK_GRID_NS):
        raise ConfigError(
            f'{place}: {step}, must be a multiple of {step.words(_TICK_GRID_NS)} '
            f'({FORCE_WINDOWS} windows of plant steps of {step.words(PLANT_STEP_NS)})')
    if not offset.is_multiple_of(PLANT_STEP_NS):
        raise ConfigError(
            f'{place}: {offset}, must be a multiple of the plant step '
            f'{offset.words(PLANT_STEP_NS)}')
    if offset.ns >= step.ns:
        raise ConfigError(f'{place}: {offset}, must be < {step}')
    return step.ns, offset.ns


def times_of(values: dict[str, Any], place: Place) -> tuple[int, int]:
    """Return macro step and offset of the REU's samples, ns; raises as `on_grid`."""
    def of(in_ms: Key, in_ns: Key) -> WrittenTime:
        if values[in_ns.name] is None:
            return WrittenTime(in_ms.name, values[in_ms.name], 'ms', 1_000_000)
        return WrittenTime(in_ns.name, values[in_ns.name], 'ns', 1)
    return on_grid(of(STEP, STEP_NS), of(OFFSET, OFFSET_NS), place)


def ticks_in(seconds: float, step_ns: int, where: str) -> int:
    """
    Return a time in ticks; ``where`` is its name in messages.

    Raises
    ------
    ConfigError
        The time is not a whole number of macro steps; the message has both.

    """
    ticks = round(seconds * 1e9 / step_ns)
    if abs(ticks * step_ns - seconds * 1e9) > 1.0:  # 1 ns, far above a double's rounding
        raise ConfigError(
            f'{where} = {seconds:g} s, must be a multiple of step_ms = {step_ns / 1e6:g} ms')
    return ticks


def _start_time(value: Any, place: Place) -> int:
    if type(value) is not int or not 0 <= value <= LATEST_START_S:
        raise ConfigError(
            f'{place} = {value!r}, must be a whole number of seconds >= 0 and <= {LATEST_START_S}')
    return value


START_TIME = Key(
    'start_time_s', Value('whole number', _start_time, 's'),
    'time of all stamps at t = 0, since 1970', None, '0', of=lambda run: run.start_time_s or None)
STEP = number('step_ms', 'ms', 'macro step H', 1.0, in_text=InText.NEVER, gt=0.0, le=100.0)
OFFSET = number(
    'controller_offset_ms', 'ms', 'offset of the samples of the REU from the ticks', 0.12,
    in_text=InText.NEVER, ge=0.0, le=100.0)
STEP_NS = nanoseconds('step_ns', 'the macro step', STEP, gt=0, le=100_000_000)
OFFSET_NS = nanoseconds('controller_offset_ns', 'the offset', OFFSET, ge=0, le=100_000_000)
