"""What is exported of an actuator: its memory before its start, and the kernels over it."""

import re
from typing import Any, NamedTuple

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.requests import start_mode
from isa_ros.actuator.ticking import group_tick, Ticked
from isa_ros.config.assembly import bodies_in_form, surroundings_of, timing_of
from isa_ros.core.frozen import frozen
from isa_ros.core.signals import Records
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import ChosenActuator
from isa_ros.export.layout import MemoryLayout
from isa_ros.export.reserved import RESERVED
from isa_ros.export.starting import start_actuator, Started
from isa_ros.reu.cascade import initial_gains
import numpy as np

PREFIX = 'isa_'
TYPES = ('about', 'command', 'fed', 'feed', 'field', 'parameter', 'port', 'reply', 'sample',
         'start')
"""What types of the header are called behind `PREFIX`."""
_WORD = re.compile(r'[a-z][a-z0-9_]*')


class Called(NamedTuple):
    """A kernel and its memory."""

    function: Any
    memory: Any

    @property
    def name(self) -> str:
        """Return the name of its machine code."""
        return f'kernel_{self.function.__name__}'


@frozen
class Exported:
    """An actuator and its kernels; its state is zero, as before its start."""

    chosen: ChosenActuator
    word: str
    """What names in C begin with."""
    actuator: SmartActuator
    start: Records
    """`START` at which it is created, (1,)."""
    ticked: Ticked
    """Memory of its tick."""
    starting: Called
    """What starts it."""
    ticking: Called
    """What makes a tick."""

    @property
    def has_own_load(self) -> bool:
        """Return whether its load is its own, and not the caller's."""
        return self.chosen.config.load is not None

    @property
    def step_ns(self) -> int:
        """Return the length of a tick."""
        return self.chosen.run.step_ns

    @property
    def kernels(self) -> tuple[Called, ...]:
        """Return all kernels with their memories."""
        return self.starting, self.ticking

    def layout(self) -> MemoryLayout:
        """Return the places of all memory, in one block."""
        return MemoryLayout(one.memory for one in self.kernels)


def word_of(actuator: str, given: str | None = None) -> str:
    """
    Return what the names of an actuator in C begin with: ``given``, or `PREFIX` and its name.

    Raises
    ------
    ConfigError
        It cannot be a name, or it is that of a type of the header, or of C or C++.

    """
    own = re.sub('[^a-z0-9_]', '_', actuator.lower())
    word = (own if own.startswith(PREFIX) else PREFIX + own) if given is None else given
    if not _WORD.fullmatch(word):
        raise ConfigError(
            f'--name {word!r}, must be lower-case letters, digits and _, a letter first')
    if word in RESERVED:
        raise ConfigError(
            f'--name {word} is a word or a type of C or C++, must be another, as {PREFIX}{word}')
    if word.removeprefix(PREFIX) in TYPES and word.startswith(PREFIX):
        raise ConfigError(f'{word} is a type of the header; choose another name with --name')
    return word


def exported(chosen: ChosenActuator, *, name: str | None = None) -> Exported:
    """
    Return what is exported of an actuator; names in C begin with ``name``, see `word_of`.

    Raises
    ------
    ConfigError
        As `word_of`.

    """
    run, row = chosen.run, chosen.row
    config = chosen.config
    start = surroundings_of(run, bodies_in_form(run)).starts()[row:row + 1]
    actuator = SmartActuator(config, timing_of(run))
    actuator.clear(float(start['position'][0]))
    own = actuator.ticked
    own.ports[:] = 0
    own.commands[:] = 0
    own.clock[0] = 0
    return Exported(
        chosen, word_of(config.name, name), actuator, start, own,
        Called(start_actuator, _started(config, start, own)),
        Called(group_tick, own))


def _started(config: ConfiguredActuator, start: Records, own: Ticked) -> Started:
    """Return the memory of the start."""
    mode = start_mode(config.name, config.mode, config.sheet.reu)
    return Started(start, np.array(initial_gains(config.sheet.reu)),
                   np.array([mode, int(config.auto_enable)], np.int64), own.memory)
