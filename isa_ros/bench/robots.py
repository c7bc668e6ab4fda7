"""Twelve actuators with a body: the quadruped's trot, its parts, and up to four robots."""

from collections.abc import Callable
from pathlib import Path
import tempfile
import time
from typing import Any

from isa_ros.bag.writer import BagWriter
from isa_ros.bench.parts import divided, in_turn, Work
from isa_ros.bench.row import Aim, Row
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.run.thinning import Thinning
from isa_ros.scripting.run import load, Run
from isa_ros.simulation import Simulation

TICKS = 300
ROUNDS = 3
SHARE = 0.25
"""Of a tick that Python drives, that its parts may leave: the loop itself."""
BEGUN = 800     # ticks, after which the robots trot
ROBOTS = (1, 2, 4)
TROT = 'isa_ros.examples.quadruped.trot:Trot'
PROGRAM: list[dict[str, float]] = [
    {'t_s': 0.0, 'height': 0.565}, {'t_s': 0.1, 'steps': 1.0}, {'t_s': 0.2},
    {'t_s': 0.6, 'speed': 0.5}]


def robot_rows() -> list[Row]:
    """Measure trots in one process, with controllers and recording, in time of the processor."""
    rows = []
    for n in ROBOTS:
        ticks = [_recorded_ticks(trotting(n)) for _ in range(ROUNDS)]
        row = Row.of(f'{12 * n} actuators, {n} quadruped{"s" if n > 1 else ""}, recording',
                     ticks, 'ticks/s')
        row = row.against('real time', row.number * 1e-3)
        rows.append(row.aiming(Aim(2500.0)) if n == 1 else row)
        if n == 1:
            rows += [part.under(row) for part in _parts(trotting(1))]
    return rows


def trotting(n: int) -> Run:
    """Return a run of so many quadrupeds, each with a trot of its own."""
    if n == 1:
        return load('quadruped', {'name': 'trot', 'duration_s': 60.0, 'controllers': {
            'trot': {'class': TROT, 'program': PROGRAM}}})
    names = [f'r{k + 1}' for k in range(n)]
    tree: dict[str, Any] = {'name': 'quadrupeds', 'robots': {
        name: {'file': 'quadruped'} for name in names}}
    bodies = [own.name for own in load(tree).configuration.bodies]
    return load(tree, {'name': 'trot', 'duration_s': 60.0, 'controllers': {
        f'trot_{k + 1}': {'class': TROT, 'program': PROGRAM, 'body': body}
        for k, body in enumerate(bodies)}})


def _begun(run: Run) -> Simulation:
    simulation = run.simulation()
    for _ in range(BEGUN):
        simulation.step()
    return simulation


def _recorded_ticks(run: Run) -> float:
    """Return the ticks a second of a run that is recorded, in time of the processor."""
    simulation = run.simulation()
    packer = packer_of(run.configuration, simulation.loop.rows.published)
    thinning = Thinning(run.configuration.record, packer.topics)
    with tempfile.TemporaryDirectory() as folder, BagWriter(
            Path(folder) / 'bag', thinning.topics, provenance_of(run.scenario)) as bag:
        simulation.loop.sinks = (RunOutput(
            packer, run.configuration.step_ns, thinning.recorder(bag), Outlets()),)
        simulation.loop.begin()
        for _ in range(BEGUN):
            simulation.step()
        start = time.process_time()
        for _ in range(TICKS):
            simulation.step()
        spent = time.process_time() - start
        simulation.loop.end()
    return TICKS / spent


def _parts(run: Run) -> list[Row]:
    """Return a tick of one quadruped that Python drives, and its parts, in processor time."""
    simulation = _begun(run)
    loop, snapshot = simulation.loop, simulation.snapshot()
    packer = packer_of(run.configuration, loop.rows.published)
    simulation.step()

    def many(work: Callable[[], object]) -> Work:
        return Work(lambda: [work() for _ in range(TICKS)],
                    lambda: simulation.restore(snapshot))

    def pack() -> None:
        packer.pack(loop.t_ns, loop.t_ns, {})
        packer.all_messages()
    times = in_turn({
        'whole': many(simulation.step),
        'the kernel of its actuators': many(
            lambda: simulation.group.advance(loop.rows.ports)),
        'its body: ports': many(lambda: simulation.surroundings.ports(loop.rows.ports)),
        'its body: a tick': many(lambda: simulation.surroundings.advance(loop.rows.replies)),
        'its controller': many(lambda: loop.transport.send(loop.ticks, loop.rows)),
        'messages': many(pack)}, TICKS)
    messages = Row('beside it, its messages', 1e6 * times.pop('messages'), 'us')
    whole = Row('a tick in memory', 1e6 * times.pop('whole'), 'us')
    return [whole, *divided(whole, times, SHARE), messages]
