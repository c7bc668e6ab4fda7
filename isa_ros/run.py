"""Bring-up: from the files of a run to its bag, in processes or in one."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count
import os
from pathlib import Path

from isa_ros.actuator import Timing
from isa_ros.bag.metadata import FILE_NAME
from isa_ros.bag.provenance import installed_versions, Provenance
from isa_ros.bag.writer import BagWriter
from isa_ros.config import load_run
from isa_ros.coordinator import Coordinator, Plan, Transport
from isa_ros.errors import BagError
from isa_ros.pacing import Laps, Pace, Progress, ProgressMeter
from isa_ros.run_config import RunConfig
from isa_ros.scenario import idle, load_scenario, Scenario
from isa_ros.shared_load import SharedLoad
from isa_ros.stopping import StopRequest
from isa_ros.topics import topics_of

RUNS = Path('runs')
JOIN_TIMEOUT_S = 30.0

Report = Callable[[Progress], None]


@dataclass(frozen=True, kw_only=True)
class Request:
    """What a user asks for; every option of `isa bringup`."""

    config: Path
    scenario: Path | None = None
    out: Path | None = None
    """None: a new directory in runs/."""
    duration_s: float | None = None
    """None: that of the scenario, else until stopped."""
    real_time_factor: float | None = None
    """None or 0: as fast as it can."""
    overwrite: bool = False
    in_process: bool = False
    namespace: str = ''
    join_timeout_s: float = JOIN_TIMEOUT_S
    laps: Laps | None = None
    """Takes the host time of every phase of the ticks."""


@dataclass(frozen=True)
class Session:
    """One run, read and checked, before anything is started."""

    request: Request
    scenario: Scenario
    out: Path
    pace: Pace

    @property
    def run(self) -> RunConfig:
        """Return the configuration that is simulated and recorded."""
        return self.scenario.run

    @property
    def timing(self) -> Timing:
        """Return the grid of time of every actuator."""
        return Timing(self.run.step_ns, self.run.controller_offset_ns)


def prepare(request: Request) -> Session:
    """
    Read the files of a run and check that its bag can be made.

    Raises
    ------
    ConfigError
        A file or an option that cannot be run.
    BagError
        The output directory exists or cannot be made.

    """
    run = load_run(request.config)
    scenario = idle(run) if request.scenario is None else load_scenario(request.scenario, run)
    if request.duration_s is not None:
        scenario = scenario.lasting(request.duration_s)
    name = run.name if request.scenario is None else f'{run.name}_{scenario.name}'
    out = request.out or next(path for path in _candidates(name) if not path.exists())
    _check_output(out, request.overwrite)
    return Session(request, scenario, out, Pace(request.real_time_factor))


def _candidates(name: str) -> Iterator[Path]:
    yield RUNS / name
    for number in count(2):
        yield RUNS / f'{name}_{number}'


def _check_output(out: Path, overwrite: bool) -> None:
    if out.exists():
        if not overwrite:
            raise BagError(f'{out} exists, must not; --overwrite replaces the bag in it')
        if not out.is_dir() or (any(out.iterdir()) and not (out / FILE_NAME).is_file()):
            raise BagError(f'{out} holds no bag ({FILE_NAME}), so it is not overwritten')
    parent = next(path for path in [out, *out.absolute().parents] if path.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        raise BagError(f'{out}: cannot be made, {parent} is not writable')


def bringup(request: Request, report: Report | None = None) -> Path:
    """
    Run and record a configuration; return the directory of its bag.

    SIGINT and SIGTERM end the run after its tick and close the bag.

    Raises
    ------
    ConfigError, BagError
        Nothing was started.
    RunError
        A participant or the recorder was lost or late; the bag is readable.
    SimulationDiverged
        A state is no longer finite; the bag is readable.
    Interrupted
        Stopped by a signal; the bag is readable.

    """
    return run_session(prepare(request), report)


def run_session(session: Session, report: Report | None = None) -> Path:
    """Run what was prepared; as `bringup`."""
    # rclpy takes a third of a second to import, which a wrong option should not cost.
    from isa_ros.nodes.session import in_one_process, in_processes
    with StopRequest() as should_stop:
        in_one = session.request.in_process
        (in_one_process if in_one else in_processes)(session, report, should_stop)
    return session.out


def record(
        session: Session, transport: Transport, load: SharedLoad,
        report: Report | None, should_stop: StopRequest) -> None:
    """Join the participants of ``transport``, run, and record every sample."""
    plan = Plan(
        step_ns=session.run.step_ns, n_actuators=len(session.run.actuators),
        n_ticks=session.scenario.n_ticks, commands=session.scenario.commands)
    duration_ns = None if plan.n_ticks is None else plan.n_ticks * plan.step_ns
    first = transport.join()
    order, topics = topics_of(session.run, load)
    with BagWriter(session.out, topics, provenance(session), session.request.overwrite) as bag:
        Coordinator(
            plan, order, transport, load, bag, pace=session.pace,
            progress=ProgressMeter(duration_ns, report), should_stop=should_stop,
            laps=session.request.laps).run(first)


def provenance(session: Session) -> Provenance:
    """Return what the bag says about its own making."""
    return Provenance(
        configuration=session.run.to_yaml(), scenario=session.scenario.to_yaml(),
        seed=0, versions=installed_versions())
