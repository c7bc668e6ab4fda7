"""Which machine code the runs of a configuration ask for: a rehearsal in which no tick runs."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
import ctypes
from importlib import import_module
from typing import Any, NamedTuple
from unittest.mock import patch
from warnings import catch_warnings, simplefilter

import isa_ros
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.ticking import tick_kernel
from isa_ros.bag.message_table import messages_in
from isa_ros.config.models.catalogue import model_names
from isa_ros.config.paths import CONFIG, SCENARIOS, shipped
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.config.runs.run_file import load_run
from isa_ros.core import kernel
from isa_ros.core.bound import run_rounds
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_key import kernels_of
from isa_ros.core.kinds import Kind
from isa_ros.core.signals import COMMAND
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.run.local_run import LocalRun
from isa_ros.run.warm_up import warmed_up
from isa_ros.run.wire.answer_loop import AnswerLoop
from isa_ros.run.wire.board import bell_of, no_board, ring_all
from isa_ros.run.wire.coordinating import TickRound
from isa_ros.scenario.scenario import load_scenario
from isa_ros.scripting.bag import ResultMessages
from isa_ros.tick.source import ScheduledSource
import numpy as np
from scripts.kernel_objects import Objects

ALONE = 'actuators alone'
"""The rehearsal of every model without a run."""
_TICKS = 4
_CONTROLLED_S = 1.0     # until a controller of the scenarios has called all of its kernels
_NEEDED = ('isa_ros.examples.', 'isa_ros.surroundings.circuits.')
"""Modules of controllers and circuits, whose numbers would be refused if they were zeros."""
_LARGEST = 65536    # bytes of a message of the wire, of which no kind depends

_NOTHING = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(lambda table: 0)
_ADDRESS = ctypes.cast(_NOTHING, ctypes.c_void_p).value or 0


class WantedKernel(NamedTuple):
    """An entry, with its kernel by name: what one process asks another one for."""

    module: str
    name: str
    kind: Kind
    is_called: bool
    symbol: str
    size: int
    """Kernels in it, of which its time of compilation is roughly a multiple."""

    @property
    def entry(self) -> KernelEntry:
        """Return the entry."""
        return KernelEntry(
            getattr(import_module(self.module), self.name), self.kind, self.is_called)


class _Nowhere:
    """A recorder that keeps nothing."""

    def write_tick(self, t_ns: int, sequence: int, messages: Sequence[Any]) -> None:
        """Do nothing."""


def tick() -> WantedKernel:
    """Return the tick of the actuators."""
    return _wanted(tick_kernel())


def rehearsals() -> list[str]:
    """Return the names of all rehearsals."""
    return [ALONE, *shipped(CONFIG)]


def rehearse(name: str, objects: Objects) -> list[WantedKernel]:
    """Return the entries that runs of a configuration ask for; objects of some are made."""
    with _noted(objects) as found:
        if name == ALONE:
            _alone()
        else:
            _run(name)
    return [_wanted(entry) for entry in found.values()]


def _alone() -> None:
    """Take a tick of every model, and a log of ticks; read a bag."""
    messages_in(b'', 0, '')
    for model in model_names():
        config = default_actuator(model, model)
        SmartActuator(config, DEFAULT_TIMING).tick()
        group = ActuatorGroup([config], DEFAULT_TIMING)
        group.advance_many(group.ticked.ports, np.zeros((1, 1), COMMAND))


def _run(name: str) -> None:
    """Take a few ticks of a configuration, in memory, recorded and over sockets."""
    with catch_warnings():      # scenarios are cut short, some are for other machines
        simplefilter('ignore')
        _ticks_of(name)


def _ticks_of(name: str) -> None:
    run = load_run(shipped(CONFIG)[name])
    for actuator in warmed_up(run)[:1]:
        AnswerLoop(actuator.ticked, actuator.advance, _LARGEST)
    own = isa_ros.load(name)
    TickRound(own.simulation().loop.rows, 1, [], False, _LARGEST, no_board())
    bell_of(ring_all, no_board())
    result = own.simulate(_TICKS * run.step_ns / NS_PER_SECOND)
    ResultMessages(own.scenario, result.log).record(_Nowhere())
    for path in shipped(SCENARIOS).values():
        with suppress(ConfigError):     # it is for actuators of another configuration
            scenario = load_scenario(path, run)
            LocalRun(scenario.run).simulate(
                _TICKS, ScheduledSource(scenario.commands, scenario.changes), _Nowhere())
            if scenario.run.controllers or scenario.run.called:     # nothing moves
                isa_ros.load(name, scenario=str(path)).simulate(_CONTROLLED_S)


@contextmanager
def _noted(objects: Objects) -> Iterator[dict[str, KernelEntry]]:
    """Note the entries that are asked for; bound kernels of ticks do nothing."""
    found: dict[str, KernelEntry] = {}

    def address_of(entry: KernelEntry) -> int:
        found[entry.symbol] = entry
        return objects.address(entry) if _runs(entry) else _ADDRESS

    def call_of(entry: KernelEntry) -> Callable[[tuple[Any, ...]], Any]:
        found[entry.symbol] = entry
        return objects.call(entry)

    kernel.entry_address.cache_clear()
    try:
        with patch.object(kernel, 'address_in_library', address_of), patch.object(
                kernel, 'call_in_library', call_of):
            yield found
    finally:
        kernel.entry_address.cache_clear()  # of what does nothing


def _runs(entry: KernelEntry) -> bool:
    """Return whether a bound kernel runs: a loop of others, or one whose numbers Python needs."""
    return entry.kernel is run_rounds or entry.kernel.__module__.startswith(_NEEDED)


def _wanted(entry: KernelEntry) -> WantedKernel:
    own = entry.kernel
    return WantedKernel(own.__module__, own.__name__, entry.kind, entry.is_called, entry.symbol,
                        len(kernels_of(own)))
