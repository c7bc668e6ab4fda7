"""
A tick over its kernels alone: what a run adds to actuators, bodies and supplies.

Time of the processor, of whole runs in this process in turn with their kernels: `Simulation`, with
its log in memory or a bag, without ROS. Where a run records, the recorder's thread counts. A run
on nodes in one process is one of its own, beside the same kernels.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from statistics import median
import tempfile
import time

from isa_ros.bench.advancing import Advancing, driving, keeping, kernels_alone
from isa_ros.bench.leg import IN_ONE_PROCESS
from isa_ros.bench.parts import divided, in_turn, ROUNDS, Work
from isa_ros.bench.recording import recording
from isa_ros.bench.rigs import config_of
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import COORDINATOR, ONE_PROCESS, Spec
from isa_ros.bench.tick import leg_drop
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.log import LogSink
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation

BEGUN = 1000    # ticks, after which the leg stands
TICKS = 1000
DRIVEN = 200    # of them by Python
SHARE = 0.25
"""Of a tick, that kernels and what keeps its rows may leave: Python between the stretches."""
TWELVE = Spec('12', ONE_PROCESS, 1200, rounds=2)
SPECS = (IN_ONE_PROCESS, TWELVE)
_MEMORY, _BAG = 'in memory', 'recording'
_WHOLE, _KERNELS = 'a tick', 'kernels'
_QUIET, _KEPT, _DRIVEN = 'kernels of quiet ticks', 'what keeps their rows', 'ticks in Python'
_LEG, _TWELVE = 'leg', '12 actuators'
_AIMS = {(_LEG, _MEMORY): Aim(1.15, True), (_LEG, _BAG): Aim(1.3, True),
         (_TWELVE, _BAG): Aim(1.2, True)}


def kernel_rows(outcomes: Outcomes) -> list[Row]:
    """Return the ratio of a tick to its kernels, for each plant and way, with its parts."""
    rows: list[Row] = []
    for name, scenario, spec in (
            (_LEG, leg_drop(), IN_ONE_PROCESS), (_TWELVE, twelve(), TWELVE)):
        for way in (_MEMORY, _BAG):
            times = _times(scenario, way)
            rows += over(f'{name}, {way}', times, _AIMS.get((name, way)))
        rows += of_nodes(name, outcomes, spec, times[_KERNELS])
    return rows


def twelve() -> Scenario:
    """Return twelve actuators with loads of their own that hold their positions."""
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as folder:
        return load(config_of(TWELVE.plant, Path(folder))).scenario


def over(name: str, times: Mapping[str, float], aim: Aim | None) -> list[Row]:
    """Return the ratio of a tick to its kernels; below it the tick and its parts, in us."""
    parts = {part: times[part] for part in (_QUIET, _KEPT, _DRIVEN)}
    tick = Row(_WHOLE, 1e6 * times[_WHOLE], 'us')
    ratio = Row(f'{name}, over its kernels', tick.number / (1e6 * times[_KERNELS]), '1')
    ratio = ratio if aim is None else ratio.aiming(aim)
    below = [tick, *divided(tick, parts, SHARE)]
    if ratio.is_reached is False:
        ratio = ratio.noting(', '.join(f'{row.name} {row.number:.1f} us' for row in below))
    return [ratio, *(row.under(ratio) for row in below)]


def of_nodes(name: str, outcomes: Outcomes, spec: Spec, kernels: float) -> list[Row]:
    """Return the ratio of the runs on nodes in one process to the ``kernels``, s."""
    spent = [run.processor[COORDINATOR] for run in outcomes.of(spec)]
    if not spent:
        return []
    row = Row.of(f'{name}, nodes in one process, recording, over its kernels',
                 [each / kernels for each in spent], '1').aiming(_AIMS[name, _BAG])
    return [row.noting(f'of a tick of {1e6 * median(spent):.1f} us: its kernels '
                       f'{1e6 * kernels:.1f} us') if row.is_reached is False else row]


def _times(scenario: Scenario, way: str) -> dict[str, float]:
    """Return the time of a tick, of the kernels of all, and of its parts, s."""
    whole, alone, kept, driven = (Simulation(scenario) for _ in range(4))
    kept_rows = recording if way == _BAG else logging
    with kept_rows(whole), kept_rows(kept), kept_rows(driven):
        for simulation in (whole, alone, kept, driven):
            Advancing(simulation, BEGUN)()
        run = Advancing(whole, TICKS)
        times = in_turn({
            _WHOLE: Work(run, clock=time.process_time),
            _KERNELS: Work(kernels_alone(alone, TICKS)),
            _KEPT: Work(keeping(kept, run), clock=time.process_time),
            _DRIVEN: Work(driving(driven, DRIVEN), clock=time.process_time)}, TICKS)
    share = run.driven_share
    return {_WHOLE: times[_WHOLE], _KERNELS: times[_KERNELS],
            _QUIET: (1.0 - share) * times[_KERNELS], _KEPT: times[_KEPT],
            _DRIVEN: share * times[_DRIVEN] * TICKS / DRIVEN}


@contextmanager
def logging(simulation: Simulation) -> Iterator[None]:
    """Let a simulation at t = 0 log what its ticks give, with room for all of them."""
    simulation.loop.sinks = (LogSink(simulation, BEGUN + (2 + ROUNDS) * TICKS),)
    simulation.loop.begin()
    yield
    simulation.loop.end()
    simulation.loop.sinks = ()
