"""The times of a run on its grid: macro steps of whole windows of plant steps, and ticks."""

from isa_ros.config.text.sections import Place
from isa_ros.core.timebase import FORCE_WINDOWS, PLANT_STEP_NS
from isa_ros.errors import ConfigError

_TICK_GRID_NS = FORCE_WINDOWS * PLANT_STEP_NS


def on_grid(step_ms: float, offset_ms: float, place: Place) -> tuple[int, int]:
    """
    Return macro step and offset of the REU's samples, ns.

    Raises
    ------
    ConfigError
        They are not whole numbers of plant steps, or the offset is not within a macro step.

    """
    step_ns = round(step_ms * 1e6)
    if step_ns % _TICK_GRID_NS or abs(step_ns - step_ms * 1e6) > 1e-3:
        raise ConfigError(
            f'{place}: step_ms = {step_ms:g} ms, must be a multiple of '
            f'{_TICK_GRID_NS / 1e6:g} ms ({FORCE_WINDOWS} windows of plant steps of '
            f'{PLANT_STEP_NS / 1e6:g} ms)')
    offset_ns = round(offset_ms * 1e6)
    if offset_ns % PLANT_STEP_NS or abs(offset_ns - offset_ms * 1e6) > 1e-3:
        raise ConfigError(
            f'{place}: controller_offset_ms = {offset_ms:g} ms, must be a '
            f'multiple of the plant step {PLANT_STEP_NS / 1e6:g} ms')
    if offset_ns >= step_ns:
        raise ConfigError(
            f'{place}: controller_offset_ms = {offset_ms:g} ms, must be < '
            f'step_ms = {step_ms:g} ms')
    return step_ns, offset_ns


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
