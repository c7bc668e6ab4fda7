"""
Courses of a fault between its begin and its end: a ramp, or on and off again.

Ticks are those since the begin. A course has no state and no generator: whether a random fault is
on in one of its periods is a hash of its seed, so that a run, its replay and a run that continues
a saved state have the same one.
"""

from collections.abc import Mapping

from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.noise import noise_key, uniforms
from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np

RAMP, INTERMITTENT = 'ramp_s', 'intermittent'
Values = Mapping[str, float]


@frozen
class Ramp:
    """Values that change linearly from those of the sound sheet, and then stay."""

    ticks: int
    """Length."""
    first: Values
    """Values of the sheet, by name."""

    def at(self, tick: int, values: Values) -> Values:
        """Return the values at a tick: of the sheet at the first one, ``values`` at the end."""
        if tick >= self.ticks:
            return values
        share = tick / self.ticks
        return {name: self.first[name] + share * (last - self.first[name])
                for name, last in values.items()}

    def ticks_of(self, length: int | None) -> range:
        """Return the ticks at which values may change, of a fault of that length."""
        return range(1 + (self.ticks if length is None else min(self.ticks, length)))

    def extremes(self, values: Values) -> tuple[Values, Values]:
        """Return the first values that are not of the sheet, and the last."""
        return self.at(1, values), values

    def tree(self, step_ns: int) -> Tree:
        """Return its key in a scenario file."""
        return {RAMP: self.ticks * step_ns / NS_PER_SECOND}


@frozen
class Intermittent:
    """A fault that comes and goes: a loose contact."""

    period: int
    """Ticks."""
    duty: float
    """Part of the time in which it is on."""
    seed: int | None
    """None: at the begin of each period; else in whole periods, each with the chance ``duty``."""
    target: str

    def at(self, tick: int, values: Values) -> Values:
        """Return the values while it is on, and none while it is off."""
        cycle, within = divmod(tick, self.period)
        if self.seed is None:
            return values if within < round(self.duty * self.period) else {}
        draw, _ = uniforms(np.uint64(noise_key(self.seed, self.target)), cycle, 0)
        return values if draw < self.duty else {}

    def ticks_of(self, length: int | None) -> list[int]:
        """Return the ticks at which it may come or go, of a fault of that length."""
        assert length is not None, 'one that never ends is refused'
        on = round(self.duty * self.period) if self.seed is None else 0
        return sorted({begin + more for begin in range(0, length, self.period)
                       for more in (0, on)} | {length})

    def extremes(self, values: Values) -> tuple[Values, Values]:
        """Return the values."""
        return values, values

    def tree(self, step_ns: int) -> Tree:
        """Return its section of a scenario file."""
        section: Tree = {'period_s': self.period * step_ns / NS_PER_SECOND, 'duty': self.duty}
        return {INTERMITTENT: section | ({} if self.seed is None else {'seed': self.seed})}


Course = Ramp | Intermittent
