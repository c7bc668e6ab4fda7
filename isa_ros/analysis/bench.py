"""
How fast this machine simulates: medians, each beside a floor measured in the same run.

A ratio holds when the machine's speed drifts; a time alone is this machine's, now.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import count, islice
import json
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
import tempfile
import time

from isa_ros import actuator_kernel as kernels
from isa_ros.actuator import SmartActuator
from isa_ros.actuator_sheet import actuator_record
from isa_ros.analysis import cylinder
from isa_ros.bag.writer import BagWriter
from isa_ros.config import load_run
from isa_ros.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.exchange import Rows
from isa_ros.pacing import Laps, Progress
from isa_ros.paths import CONFIG, find, SCENARIOS
from isa_ros.run import bringup, prepare, provenance, Request
from isa_ros.scenario import load_scenario
from isa_ros.shared_load import SharedLoad
from isa_ros.signals import LOAD_PORT
from isa_ros.stepping import SteppedActuator
from isa_ros.timebase import NS_PER_SECOND, PLANT_STEP
from isa_ros.topics import topics_of
import numpy as np

REPEATS = 7
PLANT_STEPS = 20_000
ROOTS = 40               # in a plant step
TICKS = 500
HOLDS = 10_000          # of the cylinder, ten seconds
HOLD_ROOTS = cylinder.STAGES * 4 * 2    # in a hold: four orifices, two each
RUN_SECONDS = 3.0       # simulated time of each lockstep run
WORKERS = 3             # of the pipe floor, as many as the leg has actuators
PIPE_BYTES = 1500       # about one actuator's acknowledgement


@dataclass(frozen=True)
class Row:
    """One measurement; ``ratio`` is in the direction in which more is better."""

    name: str
    value: float
    unit: str
    floor: str
    ratio: float


def bench(json_file: Path | None = None) -> list[Row]:
    """Measure everything, print a table as it grows, and write it as JSON if asked."""
    rows: list[Row] = []
    print(f'{"measurement":44} {"median":>10} {"unit":8} {"ratio":>8}  to')
    for measure in (plant_rows, cylinder_rows, tick_parts, lockstep_rows):
        for row in measure():
            rows.append(row)
            print(f'{row.name:44} {row.value:10.4g} {row.unit:8} {row.ratio:8.3g}  {row.floor}')
    if json_file is not None:
        json_file.write_text(json.dumps([asdict(row) for row in rows], indent=2) + '\n')
    return rows


def seconds(work: Callable[[], object], per: int, of_cpu: bool = False) -> float:
    """
    Return the median time of one of the ``per`` pieces of ``work`` in s, after a warm-up.

    With ``of_cpu`` the processor's time in this process instead of the wall's.
    """
    clock = time.process_time if of_cpu else time.perf_counter
    work()
    times = []
    for _ in range(REPEATS):
        start = clock()
        work()
        times.append((clock() - start) / per)
    return median(times)


def plant_rows() -> list[Row]:
    """
    Measure plant alone and plant with REU on one core, against real time.

    The machine's own speed stands beside them: the 40 square roots of a plant step (four
    evaluations, five orifices, two each), one after the other.
    """
    roots = seconds(lambda: kernels.square_roots(PLANT_STEPS * ROOTS), PLANT_STEPS)
    rows = [Row(f'floor: {ROOTS} square roots', roots * 1e6, 'us', 'itself', 1.0)]
    for model in ('smart_manifold', 'isa_v5'):
        config = default_actuator(model, model)
        bodies, rates = kernels.scratch()
        port = np.zeros(1, LOAD_PORT)
        constants = actuator_record(config.sheet, 0)
        flats = kernels.flat(bodies), kernels.flat(rates)
        step = seconds(
            lambda: kernels.body_steps(
                PLANT_STEPS, PLANT_STEP, 0.0, port[0], constants[0], bodies, rates, *flats),
            PLANT_STEPS)
        rows += [
            Row(f'{model}: plant, a step of 20 us', step * 1e6, 'us', 'real time',
                PLANT_STEP / step),
            Row(f'{model}: plant, the same', step * 1e6, 'us', 'square roots', roots / step)]
        actuator = SmartActuator(config, DEFAULT_TIMING)

        def ticks(actuator: SmartActuator = actuator) -> None:
            for _ in range(TICKS):
                actuator.tick()
        tick = seconds(ticks, TICKS)
        rows.append(Row(f'{model}: plant + REU, a tick of 1 ms', tick * 1e6, 'us',
                        'real time', DEFAULT_TIMING.step_ns / NS_PER_SECOND / tick))
    return rows


def cylinder_rows() -> list[Row]:
    """
    Measure the valve-driven cylinder in simulated s per CPU s, and its error beside it.

    The error is the largest of the position at any hold of ten seconds, from a solution in
    steps of a sixteenth; the ratio is to the nanometre asked for.
    """
    roots = seconds(lambda: kernels.square_roots(HOLDS * HOLD_ROOTS), HOLDS, of_cpu=True)
    cylinders = cylinder.cylinder_record()
    states = cylinder.at_rest(HOLDS, cylinders[0])
    hold = seconds(
        lambda: cylinder.cylinder_run(1, cylinders, states), HOLDS, of_cpu=True)
    error = float(np.abs(states - cylinder.simulate(HOLDS, 16))[:, 0].max())
    return [
        Row(f'floor: {HOLD_ROOTS} square roots', roots * 1e6, 'us', 'itself', 1.0),
        Row('cylinder, order 8, a step of 1 ms', cylinder.HOLD / hold, 's/CPU s',
            'square roots', roots / hold),
        Row('cylinder: its largest error', error, 'm', 'a nanometre', 1e-9 / error)]


def tick_parts() -> list[Row]:
    """Measure what the leg's tick is made of, without ROS; the ratio is to a whole tick."""
    run = load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG))).run
    timing = DEFAULT_TIMING
    load = SharedLoad(run)
    starts, rows = load.starts(run), Rows(len(run.actuators))
    ports, replies = rows.ports, rows.replies
    load.ports(ports)
    parts = {}
    stepped = [SteppedActuator(config, timing) for config in run.actuators]
    for actuator, start in zip(stepped, starts):
        actuator.start(start)

    def kernels_only() -> None:
        for _ in range(TICKS):
            for k, actuator in enumerate(stepped):
                actuator.actuator.tick(ports[k])

    def with_messages() -> None:
        for _ in range(TICKS):
            for k, actuator in enumerate(stepped):
                actuator.advance(ports[k])
                actuator.states()
    parts['three actuators: plant + REU'] = seconds(kernels_only, TICKS)
    for k, actuator in enumerate(stepped):
        actuator.start(starts[k])
    parts['three actuators: their messages'] = (
        seconds(with_messages, TICKS) - parts['three actuators: plant + REU'])

    def leg() -> None:
        for _ in range(TICKS):
            load.ports(ports)
            load.advance(replies)
    replies['mean_forces'] = starts['force'][:, None]
    parts['leg and supply'] = seconds(leg, TICKS)
    parts['leg and supply: their messages'] = seconds(
        lambda: [(load.messages(k), load.clock(k)) for k in range(TICKS)], TICKS)
    parts['recorder'] = _recorder_seconds(load, stepped)
    whole = sum(parts.values())
    return [Row(f'tick of the leg: {name}', value * 1e6, 'us', 'sum of the parts', value / whole)
            for name, value in parts.items()]


def _recorder_seconds(load: SharedLoad, stepped: Sequence[SteppedActuator]) -> float:
    """Return the time of one tick's 22 messages in the recorder, in s."""
    with tempfile.TemporaryDirectory() as directory:
        session = prepare(_request(Path(directory)))
        order, topics = topics_of(session.run, load)
        messages = order.merge(
            [*((*actuator.advance(None), *actuator.states()) for actuator in stepped),
             [load.clock(0)],
             load.messages(0)])
        ticks = count()
        with BagWriter(session.out, topics, provenance(session)) as bag:
            def work() -> None:
                for tick in islice(ticks, TICKS):
                    bag.write_tick(tick * session.run.step_ns, tick, messages)
            return seconds(work, TICKS)


def _request(directory: Path, in_process: bool = True, laps: Laps | None = None) -> Request:
    """Return the leg's drop, recorded below a directory."""
    return Request(
        config=find('leg.yaml', CONFIG), scenario=find('drop.yaml', SCENARIOS),
        out=directory / 'bag', duration_s=RUN_SECONDS, in_process=in_process, laps=laps)


def lockstep_rows() -> list[Row]:
    """
    Measure the leg's drop with recording, in processes and in one, and the pipe floor.

    Below each, where the coordinator spends a tick; in processes the recorder works while the
    actuators do, and ``actuators`` is the wait for them.
    """
    pipe = pipe_exchange()
    rows = [Row(f'floor: {WORKERS} workers on pipes, no work', pipe * 1e6, 'us', 'itself', 1.0)]
    for in_process in (False, True):
        factor, phases = leg_run(in_process)
        tick = 1e-3 / factor
        name = 'one process' if in_process else 'a process per actuator'
        rows += [
            Row(f'leg, recording, {name}', 1.0 / tick, 'ticks/s', 'real time', factor),
            Row(f'leg, recording, {name}: a tick', tick * 1e6, 'us', 'pipe floor', pipe / tick)]
        rows += [Row(f'  {phase}', spent * 1e6, 'us', 'that tick', spent / tick)
                 for phase, spent in phases.items()]
    return rows


def leg_run(in_process: bool) -> tuple[float, dict[str, float]]:
    """Return the real-time factor of the leg's drop without start-up, and s a tick by phase."""
    factors: list[float] = []
    laps = Laps()

    def report(progress: Progress) -> None:
        if progress.is_last:
            factors.append(progress.real_time_factor)
    with tempfile.TemporaryDirectory() as directory:
        bringup(_request(Path(directory), in_process, laps), report)
    ticks = RUN_SECONDS * 1e3
    return factors[0], {
        phase: spent / ticks for phase, spent in laps.spent.items() if phase != 'between ticks'}


def pipe_exchange() -> float:
    """Return the time of one exchange with `WORKERS` processes that do nothing, in s."""
    context = get_context('spawn')
    pipes = [context.Pipe() for _ in range(WORKERS)]
    workers = [context.Process(target=_answer, args=(theirs,)) for _, theirs in pipes]
    for worker in workers:
        worker.start()
    payload = bytes(PIPE_BYTES)

    def exchange() -> None:
        for _ in range(TICKS):
            for ours, _ in pipes:
                ours.send_bytes(payload)
            for ours, _ in pipes:
                ours.recv_bytes()
    result = seconds(exchange, TICKS)
    for (ours, _), worker in zip(pipes, workers):
        ours.send_bytes(b'')
        worker.join()
    return result


def _answer(pipe: Connection) -> None:
    while message := pipe.recv_bytes():
        pipe.send_bytes(message)
