"""The leg's drop in memory: beside its kernels alone, with a controller, and many at once."""

from collections.abc import Callable, Mapping
import os
from statistics import median
import time

from isa_ros.bench.row import Aim, REPEATS, Row, seconds
from isa_ros.bench.tick import leg_drop
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.conditions import CONDITIONS
from isa_ros.core.signals import LOAD_PORT
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.run import load, Run
from isa_ros.scripting.sweep import sweep
from isa_ros.simulation import Simulation
import numpy as np

TICKS = 500
N_DROPS = 200
_KERNEL = 'the kernel of three actuators'
_JOINTS = ('haa', 'hfe', 'kfe')
_LEAST = 1e-6   # part of a rating: lower than anything measured


class _Holder(Controller):
    """Commands one actuator to hold its position, at every tick."""

    def step(self, state: State) -> dict[str, Setpoint]:
        return {'kfe': Setpoint(position=state.actuators['kfe'].position)}


def in_memory_rows() -> list[Row]:
    """Measure a tick in memory in time of the processor, and a sweep in time of the host."""
    drop = leg_drop()
    kernels = _kernel_seconds(drop)
    alone = _simulated(Simulation(drop))
    return [
        Row(f'floor: {_KERNEL}', kernels * 1e6, 'us'),
        Row.of('the protection adds to that kernel', _watching_percent({}), '%'),
        Row.of('the protection with a level for every condition adds to it',
               _watching_percent(every_level()), '%').aiming(Aim(8.0, True)),
        Row('a tick of the leg', alone * 1e6, 'us', _KERNEL, kernels / alone),
        Row('a tick of the leg over the kernel', alone / kernels, '1').aiming(Aim(2.0, True)),
        Row('a controller adds to a tick', _added_seconds(drop) * 1e6, 'us').aiming(
            Aim(20.0, True)),
        *_sweep_rows()]


def _simulated(simulation: Simulation) -> float:
    """Return the time per tick of the first `TICKS` ticks, in s."""
    return seconds(lambda: _run(simulation), TICKS, of_cpu=True)


def _run(simulation: Simulation) -> None:
    simulation.reset()
    for _ in range(TICKS):
        simulation.step()


def _added_seconds(drop: Scenario) -> float:
    """Return the time that a controller adds to a tick, in s: of runs with and without in turn."""
    alone, controlled = Simulation(drop), Simulation(drop, [_Holder()])
    differences = []
    for _ in range(1 + 2 * REPEATS):
        start = time.process_time()
        _run(alone)
        between = time.process_time()
        _run(controlled)
        differences.append(time.process_time() - between - (between - start))
    return median(differences[1:]) / TICKS


def every_level() -> dict[str, float]:
    """
    Return a level that is not reached for every one that is off as shipped, by key.

    Those of link and watchdog are part of a link.
    """
    found = {'setpoint_timeout_ms': 3.6e6}
    for condition in CONDITIONS:
        own = condition.levels
        if own is None:
            continue
        unreached = own.most if condition.is_above else _LEAST
        if not own.trip:
            found[f'{condition.name}.trip'] = unreached
        if not own.warning:
            found[f'{condition.name}.warning'] = own.trip or unreached
    return found


def _watching_percent(levels: Mapping[str, float]) -> list[float]:
    """Return what watching with ``levels`` adds to the kernel, in %, with and without in turn."""
    watched, off = (_kernel_work(load('leg', 'drop').replace({
        f'actuators.{joint}.parameters.reu.protection.{key}': value
        for joint in _JOINTS for key, value in values.items()}).scenario)
        for values in (levels, {'switch': 'off'}))
    found = []
    for _ in range(1 + 3 * REPEATS):
        start = time.process_time()
        watched()
        between = time.process_time()
        off()
        found.append(100.0 * ((between - start) / (time.process_time() - between) - 1.0))
    return found[1:]


def _kernel_seconds(drop: Scenario) -> float:
    """Return the time of the actuators' kernel alone, with the ports of the real ticks, in s."""
    return seconds(_kernel_work(drop), TICKS, of_cpu=True)


def _kernel_work(drop: Scenario) -> Callable[[], None]:
    """Return what runs the actuators' kernel alone for `TICKS` ticks."""
    simulation = Simulation(drop)
    ports: list[np.ndarray] = []
    take: Callable[[np.ndarray], None] = simulation.surroundings.ports
    for _ in range(TICKS):
        port = np.zeros(len(simulation.names), LOAD_PORT)
        take(port)
        ports.append(port)
        simulation.step()
    group, starts = group_of(drop.run), surroundings_of(drop.run).starts()

    def work() -> None:
        group.start(starts)
        for port in ports:
            group.advance(port)
    return work


def _sweep_rows() -> list[Row]:
    run = load('leg.yaml', 'drop.yaml')
    n_cores = os.cpu_count() or 1
    one, all_cores = _sweep_seconds(run, 1), _sweep_seconds(run, n_cores)
    return [
        Row(f'sweep of {N_DROPS} drops in one process', one, 's'),
        Row(f'sweep of {N_DROPS} drops in {n_cores} processes', all_cores, 's',
            'one process', one / all_cores)]


def _sweep_seconds(run: Run, workers: int) -> float:
    """Return the time of a sweep of the supply's pressure, in s."""
    pressures = np.linspace(16.0, 21.0, N_DROPS).tolist()
    start = time.perf_counter()
    sweep(run, {'supply.pressure_mpa': pressures}, workers=workers, measure={
        'peak': lambda result: float(result['kfe.force'].max())}, progress=True)
    return time.perf_counter() - start
