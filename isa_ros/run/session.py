"""Sessions: read and check the files of a run, then run it and record its bag."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import field
import gc
from itertools import count
import os
from pathlib import Path

from isa_ros.bag.directory import files_to_replace
from isa_ros.bag.provenance import installed_versions
from isa_ros.bag.writer import BagWriter
from isa_ros.config.assembly import request_range_of, surroundings_in_form
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import changes_of
from isa_ros.core.frozen import frozen
from isa_ros.core.saved_state import read_state, RunState, write_state
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.topic import Topic
from isa_ros.errors import BagError, ConfigError
from isa_ros.run.coordinator import Coordinator, Requests
from isa_ros.run.options import Request
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.pacing import JOINING, Pace, ProgressMeter, RunProgress, STARTING
from isa_ros.run.provenance import provenance_of
from isa_ros.run.thinning import Thinning
from isa_ros.scenario.scenario import planned, Scenario
from isa_ros.surroundings.surroundings import Surroundings
from isa_ros.tick.emergency_stop import emergency_stops_of
from isa_ros.tick.exchange import Rows, RowSink, Transport
from isa_ros.tick.source import ScheduledSource, Source
from isa_ros.tick.tick_loop import ignore, TickLoop
from isa_ros.tick.trips import TripLog

RUNS = Path('runs')

Report = Callable[[RunProgress], None]


@frozen
class Session:
    """One run, read and checked; nothing is started yet."""

    request: Request
    scenario: Scenario
    out: Path
    pace: Pace
    state: RunState | None = None
    """State the run continues from; None: it begins at t = 0."""
    source: Callable[[], AbstractContextManager[Source]] | None = None
    """Opens the source of the commands, once all participants are ready; None: the scenario."""
    bags: list[Path] = field(default_factory=list)
    """Bags of the run so far: `out`, and one more for each reset."""
    lines: list[str] = field(default_factory=list)
    """What the devices did by themselves, to print at the end; complete once the run has ended."""
    tripped: list[str] = field(default_factory=list)
    """Those of `lines` that are trips."""

    @property
    def run(self) -> RunConfig:
        """Return the configuration that is simulated and recorded."""
        return self.scenario.run

    @property
    def warnings(self) -> tuple[str, ...]:
        """Return lines to print before the run."""
        return self.scenario.warnings

    @property
    def is_as_wanted(self) -> bool:
        """Return whether nothing tripped, or trips are no failure of this run."""
        return not (self.tripped and self.request.fail_on_trip)

    def freeze_objects(self) -> None:
        """Exclude loaded objects from garbage collection, which would pause a run for 60 ms."""
        if self.request.is_alone:
            gc.freeze()

    def opened_source(self) -> AbstractContextManager[Source]:
        """Return the source of the commands."""
        if self.source is not None:
            return self.source()
        return nullcontext(ScheduledSource(
            self.scenario.commands, self.scenario.changes,
            next_command=self.scenario.next_command))


def _unchanged(run: RunConfig) -> RunConfig:
    """Return the run itself."""
    return run


def prepare(
        request: Request, adapted: Callable[[RunConfig], RunConfig] = _unchanged, *,
        has_bus: bool = False) -> Session:
    """
    Read the files of a run and check that its bag can be made.

    ``adapted`` returns the run of the file as it is simulated and recorded; ``has_bus``: whether
    the master of a bus commands it.

    Raises
    ------
    ConfigError
        A file or an option is invalid.
    BagError
        The output directory already exists or cannot be created.

    """
    changes = changes_of(request.all_changes)
    run = adapted(load_run(request.config, changes.run)).with_controllers(
        request.controllers).stored(request.compression, request.split_mb, 'record options')
    for body in run.bodies:
        body.refuse_absent(run.source)
    if run.record.thins or run.publish.decimate:
        rows = Rows(len(run.actuators), surroundings_in_form(run))
        topics = packer_of(run, rows.published).topics
        run.record.refuse_misfits([topic.name for topic in topics], run.source)
        run.publish.refuse_misfits(topics, run.source)
    scenario = planned(request.scenario, run, changes)
    if not has_bus:
        scenario.refuse_bus()
    for controller in scenario.run.called:
        controller.made(scenario.run)   # refuses what the run could not begin with
    if request.duration_s is not None:
        scenario = scenario.lasting(request.duration_s)
    if request.in_process and request.elsewhere:
        raise ConfigError(
            f'--elsewhere {",".join(request.elsewhere)} cannot be used with --in-process, which '
            'runs all actuators in this process; leave one out')
    run.names_here(request.elsewhere)
    name = run.name if request.scenario is None else f'{run.name}_{scenario.name}'
    if request.namespace:
        name = f'{request.namespace.replace("/", "_")}_{name}'
    out = request.out or _unused(RUNS / name)
    _check_output(out, request.overwrite)
    save = request.save
    if save is not None and save.exists() and not (request.overwrite and save.is_file()):
        raise ConfigError(f'--save {save}: already exists; --overwrite replaces a file')
    state = None
    if request.restore is not None:
        state = read_state(request.restore, scenario.run.digest)
        n_ticks, seconds = scenario.n_ticks, scenario.run.step_ns / NS_PER_SECOND
        if n_ticks is not None and state.tick >= n_ticks:
            raise ConfigError(
                f'--restore {request.restore}: t = {state.tick * seconds:g} s, must be before '
                f'the end of the run, {n_ticks * seconds:g} s')
    return Session(request, scenario, out, Pace(request.real_time_factor), state)


def _candidates(directory: Path) -> Iterator[Path]:
    yield directory
    for number in count(2):
        yield directory.with_name(f'{directory.name}_{number}')


def _unused(directory: Path) -> Path:
    return next(path for path in _candidates(directory) if not path.exists())


def _check_output(out: Path, overwrite: bool) -> None:
    files_to_replace(out, overwrite)
    parent = next(path for path in [out, *out.absolute().parents] if path.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        raise BagError(f'{out}: cannot be created, {parent} is not writable')


def _no_warning(line: str) -> None:
    """Print nothing."""


def record(
        session: Session, transport: Transport, surroundings: Surroundings,
        outlets: Callable[[Sequence[Topic]], Outlets], report: Report | None,
        should_stop: Callable[[], bool], requests: Requests | None = None,
        warn: Callable[[str], object] = _no_warning, sinks: Sequence[RowSink] = ()) -> None:
    """
    Join the participants of ``transport``, run, and record every sample.

    ``outlets`` creates the publishers for the topics of supplies and body. A reset starts again
    at t = 0, with another bag beside the first. ``warn`` prints a line; ``sinks`` take the rows
    too.
    """
    run, laps = session.run, session.request.laps
    lap = ignore if laps is None else laps.lap
    rows = Rows(len(run.actuators), surroundings, transport.group)
    packer = packer_of(run, rows.published)
    published = outlets(packer.surroundings)
    thinning = Thinning(run.record, packer.topics)
    n_ticks, state, out = session.scenario.n_ticks, session.state, session.out
    is_paused = session.request.is_paused
    if state is not None:
        packer.rare.announce()
    trip_log = TripLog([(own.name, own.sheet.is_rotary) for own in run.actuators])
    with ExitStack() as at_end, session.opened_source() as source:
        at_end.callback(_keep, trip_log, session)
        loop = TickLoop(
            run.step_ns, transport, surroundings, rows, source,
            stops=emergency_stops_of(run, surroundings),
            request_range=(
                request_range_of(run) if run.controllers or run.called else None), warn=warn,
            lap=lap)
        while True:
            lap(STARTING)
            loop.join()
            lap(JOINING)
            # Only the first bag may replace one: a reset uses a directory that does not exist.
            overwrite = session.request.overwrite and not session.bags
            provenance = provenance_of(session.scenario, state, surroundings.provenance)
            with BagWriter(out, thinning.topics, provenance, overwrite,
                           run.record.storage, session.request.is_synced) as bag:
                session.bags.append(out)
                loop.sinks = (  # at the end they may have events for the bag
                    *sinks, RunOutput(packer, run.step_ns, thinning.recorder(bag), published,
                                      period_of=run.publish.period), trip_log)
                coordinator = Coordinator(
                    loop, n_ticks, pace=session.pace, progress=ProgressMeter(
                        None if n_ticks is None else n_ticks * run.step_ns, report),
                    should_stop=should_stop, requests=requests,
                    is_paused=is_paused)
                coordinator.run(state)
            if not coordinator.is_reset:
                break
            out, state = _unused(session.out), None
            is_paused = (session.request.is_paused if coordinator.restarts_paused is None
                         else coordinator.restarts_paused)
    if session.request.save is not None:
        save(session, coordinator, session.request.save)


def _keep(trip_log: TripLog, session: Session) -> None:
    """Keep in a session what is to be printed at its end."""
    session.tripped.extend(trip_log.tripped.lines())
    session.lines.extend(trip_log.lines())


def save(session: Session, coordinator: Coordinator, path: Path) -> None:
    """
    Save the state of a run between two ticks in a file.

    Raises
    ------
    RunError
        The file cannot be written, or a participant cannot be saved.
    SimulationDiverged
        A number of the state is not finite.

    """
    write_state(path, coordinator.save().to_json(session.run.digest, installed_versions()))


def save_in_bag(session: Session, coordinator: Coordinator) -> str:
    """Save the state of a run beside the messages of its bag and return the path."""
    path = session.bags[-1] / f'state_{coordinator.ticks}.json'
    save(session, coordinator, path)
    return str(path)
