"""
Time is integer nanoseconds of simulation everywhere: ``t_ns = k * step_ns``.

The plant steps at 20 us; every other period is a whole number of those steps.
"""

from isa_ros.errors import ConfigError

NS_PER_SECOND = 1_000_000_000
PLANT_STEP_NS = 20_000  # the fixed RK4 step
PLANT_STEP = PLANT_STEP_NS / NS_PER_SECOND
FASTEST_RATE = 1.6 / PLANT_STEP  # 1/s; a decay that an RK4 step damps best, to 0.27
FORCE_WINDOWS = 5  # mean forces per macro step that the load receives


def steps_in(period_ns: int, name: str) -> int:
    """
    Return the number of plant steps in one period.

    Raises
    ------
    ConfigError
        The period is not a positive whole number of plant steps.

    """
    if period_ns <= 0 or period_ns % PLANT_STEP_NS:
        raise ConfigError(
            f'{name} = {period_ns / 1e6:g} ms, must be a positive multiple of the plant step '
            f'{PLANT_STEP_NS / 1e6:g} ms')
    return period_ns // PLANT_STEP_NS
