"""The supply of a unit: its kernels before and after the actuator in a tick, over one block."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, Records, SUPPLY_PORT, SUPPLY_REPLY
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import ChosenActuator
from isa_ros.export.exported import Called
from isa_ros.export.layout import MemoryLayout
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.supply_tick import Answers
import numpy as np


class UnitSupply(NamedTuple):
    """The supply that feeds one actuator alone; a row of each record."""

    config: SupplyConfig
    sample: Records
    """`SUPPLY_SAMPLE`."""
    ports: Records
    """`LOAD_PORT`: it fills the pressures."""
    feeds: Records
    """`SUPPLY_PORT`, filled if the pressure moves within a tick."""
    replies: Records
    """`LOAD_REPLY` of the tick."""
    fed: Records
    """`SUPPLY_REPLY` of the tick."""
    answers: Records
    """`SUPPLY_REPLY` of the last tick; no row if the pressure is held."""
    before: tuple[Called, ...]
    """What it does before the actuator in a tick."""
    after: tuple[Called, ...]

    @property
    def has_feed(self) -> bool:
        """Return whether its pressure moves within a tick."""
        return len(self.answers) > 0

    @property
    def kernels(self) -> tuple[Called, ...]:
        """Return all kernels with their memories."""
        return *self.before, *self.after

    def layout(self) -> MemoryLayout:
        """Return the places of all its memory, in one block."""
        return MemoryLayout((*(one.memory for one in self.kernels),
                             (self.ports, self.feeds, self.replies, self.fed)))


def supplied(chosen: ChosenActuator) -> UnitSupply:
    """
    Return the supply of an actuator, which it then has for itself.

    Raises
    ------
    ConfigError
        It is a circuit of lines and manifolds.

    """
    run, config = _alone(chosen)
    if isinstance(config.sheet, CircuitSupply):
        raise ConfigError(
            f'{chosen.config.name}: its supply {config.name} is a circuit, must be constant or a '
            'pump with an accumulator for a unit (--fmu); a library (--c) takes its pressures '
            'from outside')
    surroundings = surroundings_of(run)
    ports, feeds, replies, fed = (
        np.zeros(1, record) for record in (LOAD_PORT, SUPPLY_PORT, LOAD_REPLY, SUPPLY_REPLY))
    parts = surroundings.parts(ports, feeds, replies, fed)
    assert parts is not None    # it has no body
    before, after = (tuple(Called(part.bound.function, part.bound.memory) for part in side)
                     for side in parts)
    return UnitSupply(config, surroundings.supplies[:1], ports, feeds, replies, fed,
                      _answers(after), before, after)


def _alone(chosen: ChosenActuator) -> tuple[RunConfig, SupplyConfig]:
    """Return a run of nothing but the actuator and its supply, and the supply."""
    name = chosen.config.name
    own = next(supply for supply in chosen.run.supplies if name in supply.feeds).feeding([name])
    return replace(
        chosen.run, actuators=(chosen.config,), bodies=(), controllers=(), called=(),
        emergency_stops=(), supplies=(own,)), own


def _answers(after: tuple[Called, ...]) -> Records:
    """Return what the actuator answered in the last tick, as the kernels keep it."""
    return next(_kept(after), np.zeros(0, SUPPLY_REPLY))


def _kept(after: tuple[Called, ...]) -> Iterator[Any]:
    yield from (one.memory.kept for one in after if isinstance(one.memory, Answers))
