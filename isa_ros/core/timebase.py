"""
Time is integer nanoseconds of simulation everywhere: ``t_ns = k * step_ns``.

The plant steps at 20 us; every other period is a whole number of those steps.
"""

from isa_ros.errors import ConfigError

NS_PER_SECOND = 1_000_000_000
PLANT_STEP_NS = 20_000  # the fixed RK4 step
PLANT_STEP = PLANT_STEP_NS / NS_PER_SECOND
FASTEST_RATE = 1.6 / PLANT_STEP  # 1/s; a decay that an RK4 step damps best, to 0.27
MAX_STEP_NS = 100_000_000
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


def refuse_grid(step_ns: int, offset_ns: int, where: str) -> None:
    """
    Refuse an invalid macro step or offset of the controllers' samples.

    Raises
    ------
    ConfigError
        One is outside its range or not a whole number of plant steps.

    """
    grid_ns = FORCE_WINDOWS * PLANT_STEP_NS
    if not 0 < step_ns <= MAX_STEP_NS or step_ns % grid_ns:
        raise ConfigError(
            f'{where}: step_ns = {step_ns:g} ns, must be > 0 and <= {MAX_STEP_NS} ns and a '
            f'multiple of {grid_ns} ns')
    if not 0 <= offset_ns < step_ns or offset_ns % PLANT_STEP_NS:
        raise ConfigError(
            f'{where}: controller_offset_ns = {offset_ns:g} ns, must be >= 0 and < step_ns = '
            f'{step_ns} ns and a multiple of {PLANT_STEP_NS} ns')
