"""
Scenarios: the commands of each actuator by tick, faults, and changes of the rig for them.

Values are SI with the names of the setpoint topic. A scenario that replaces loads or the start
of a body, or has controllers, gives its own `run`: the configuration to simulate, record and
replay.
"""

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
import math
from pathlib import Path
from typing import Any

from isa_ros.config.runs.controller_config import CONTROLLERS, controllers_at
from isa_ros.config.runs.low_supply import low_supplies
from isa_ros.config.runs.run_config import ROBOTS, RunConfig
from isa_ros.config.runs.supply_settings import defeated_settings
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.changes import changed, Changes, SCENARIO
from isa_ros.config.text.names import name_of, parted
from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import dump, parse, read, Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.changes_together import refuse_changes
from isa_ros.scenario.fault_reading import read_faults
from isa_ros.scenario.faults import BUS, Fault, ParameterChanges, timetable
from isa_ros.scenario.figures import figure_of
from isa_ros.scenario.keys import SCENARIO as SCENARIO_KEYS
from isa_ros.scenario.range_check import ACCEPT, within_range
from isa_ros.scenario.rig_changes import refuse_stranger, with_loads, with_starts
from isa_ros.scenario.robots import with_robots
from isa_ros.scenario.setpoints import MAX_DURATION, read_track
from isa_ros.scenario.track import event_tree, Track
import numpy as np
from numpy.typing import NDArray

BEYOND = 'beyond_range'


@frozen
class Scenario:
    """The commands of a run, and the run they are meant for."""

    name: str
    run: RunConfig
    """With the scenario's own loads and starts of bodies: simulate and record this one."""
    n_ticks: int | None
    """None: until stopped."""
    tracks: tuple[Track, ...]
    figure: str | None = None
    """One of `FIGURES`, which `isa report` draws first."""
    accepts_beyond: bool = False
    """Whether setpoints beyond the range of their actuators are taken as they are."""
    limited: tuple[str, ...] = field(default=(), compare=False)
    """Lines on the setpoints that are limited to the range of their actuators."""
    faults: tuple[Fault, ...] = ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """Return lines to print before the run."""
        of_run = (*low_supplies(self.run), *defeated_settings(self.run), *(
            line for body in self.run.bodies for line in body.warnings(self.run.step_ns)))
        return (*self.limited, *(f'{self.run.source}: {line}' for line in of_run))

    @property
    def duration_s(self) -> float | None:
        """Return the duration in s, None for a scenario without end."""
        return None if self.n_ticks is None else self.n_ticks * self.run.step_ns / NS_PER_SECOND

    def lasting(self, duration: float) -> 'Scenario':
        """
        Return the scenario with another duration in s, without what begins after its end.

        Raises
        ------
        ConfigError
            The duration is not a positive whole number of ticks.

        """
        n_ticks = _duration(duration, self.run.step_ns, 'duration')
        return replace(
            self, n_ticks=n_ticks, tracks=tuple(_before(n_ticks, self.tracks)),
            faults=tuple(fault for fault in self.faults if fault.tick < n_ticks))

    def with_faults(self, faults: Sequence[Tree]) -> 'Scenario':
        """
        Return the scenario with more faults, as its file would have them.

        Raises
        ------
        ConfigError
            As `read_faults`; an index is that of ``faults``.

        """
        place = Place('the given faults', 'faults')
        added = read_faults(faults, place, self.run, self.n_ticks)
        if self.faults:
            _refuse_together(
                (*self.faults, *added), self.run, f'faults of {self.name} and given ones')
        return replace(self, faults=(*self.faults, *added))

    def refuse_bus(self) -> None:
        """
        Refuse faults of connections to a bus, in a run without one.

        Raises
        ------
        ConfigError
            There are some.

        """
        for fault in self.faults:
            if fault.of == BUS:
                raise ConfigError(
                    f'{self.name}: a fault of bus: {fault.target} is used under isa bus only; '
                    'link: has those of a modelled link')

    @cached_property
    def changes(self) -> Mapping[int, ParameterChanges]:
        """Return the parameters that faults change, by tick."""
        return timetable(self.faults, self.run)

    def has_commands_at(self, tick: int) -> bool:
        """Return whether a command of the scenario takes effect at a tick."""
        return tick in self._events or tick >= self._first_motion

    def next_command(self, tick: int) -> float:
        """Return the first tick from ``tick`` on with a command; infinite: none comes."""
        if tick >= self._first_motion:
            return tick
        k = bisect_left(self._event_ticks, tick)
        return self._event_ticks[k] if k < len(self._event_ticks) else math.inf

    @cached_property
    def _event_ticks(self) -> list[int]:
        return sorted(self._events)

    @cached_property
    def _events(self) -> frozenset[int]:
        return frozenset(event.tick for track in self.tracks for event in track.events)

    @cached_property
    def _first_motion(self) -> float:
        """Return the tick from which on a motion may go on."""
        return min((event.tick for track in self.tracks for event in track.events
                    if event.motion is not None), default=math.inf)

    def commands(self, tick: int, out: NDArray[np.void]) -> None:
        """Write this tick's commands into ``out``, `COMMAND` rows of shape (n_actuators,)."""
        if not self.has_commands_at(tick):
            return
        for track in self.tracks:
            event = track.at(tick)
            if event is not None:
                event.write(tick, self.run.step_ns, out[self.run.index(track.actuator)])

    def to_yaml(self) -> str:
        """Return the scenario as a scenario file with every position as a number."""
        tree: Tree = {'name': self.name}
        if self.figure is not None:
            tree['figure'] = self.figure
        if self.duration_s is not None:
            tree['duration_s'] = self.duration_s
        if self.accepts_beyond:
            tree[BEYOND] = ACCEPT
        tree['tracks'] = {
            track.actuator: [event_tree(event, self.run.step_ns) for event in track.events]
            for track in self.tracks}
        if self.faults:
            tree['faults'] = [fault.tree(self.run.step_ns) for fault in self.faults]
        return dump(tree)


def _before(n_ticks: int, tracks: Sequence[Track]) -> Iterator[Track]:
    """Yield the tracks up to a tick, those that have begun."""
    for track in tracks:
        events = tuple(event for event in track.events if event.tick < n_ticks)
        if events:
            yield replace(track, events=events)


def idle(run: RunConfig, duration: float | None = None) -> Scenario:
    """Return the scenario without commands: every actuator holds its start position."""
    scenario = Scenario('idle', run, None, ())
    return scenario if duration is None else scenario.lasting(duration)


def load_scenario(path: Path | str, run: RunConfig) -> Scenario:
    """
    Return the scenario of a file for a run.

    Raises
    ------
    ConfigError
        The file cannot be read, or does not fit the run.

    """
    path = Path(path)
    return read_scenario(read(path), Place.of(path), run)


def planned(path: Path | None, run: RunConfig, changes: Changes) -> Scenario:
    """
    Return the scenario of a file with some values changed, or without a file the idle one.

    Raises
    ------
    ConfigError
        As `load_scenario`, or there are changes and no file.

    """
    if path is not None:
        return read_scenario(
            changed(read(path), changes.scenario, path.name), Place.of(path), run)
    for key in changes.scenario:
        raise ConfigError(f'--set {SCENARIO}{key} is not used: the run has no scenario')
    return idle(run)


def scenario_of(text: str, run: RunConfig, name: str = 'scenario.yaml') -> Scenario:
    """Return the scenario of a text; as `load_scenario`."""
    return read_scenario(parse(text, name), Place(name), run)


def read_scenario(tree: Tree, place: Place, run: RunConfig) -> Scenario:
    """Return the scenario of a file's tree; as `load_scenario`."""
    _refuse_robots(tree, run, place)
    tree = with_robots(tree, place)
    refuse_unknown(tree, SCENARIO_KEYS, place)
    name = name_of(tree, 'name', place)
    n_ticks = _duration(tree.get('duration_s'), run.step_ns, f'{place}: duration_s')
    run = with_loads(with_starts(run, tree, place), tree, place)
    if CONTROLLERS in tree:
        run = run.calling(controllers_at(
            tree[CONTROLLERS], place / CONTROLLERS, run.called))
    sections = section_at(tree.get('tracks', {}), place / 'tracks')
    accepts_beyond = _accepts_beyond(tree, place)
    tracks: list[Track] = []
    limited: list[str] = []
    for name_there, points in sections.items():
        below = place / 'tracks' / name_there
        refuse_stranger(name_there, run, below)
        track = read_track(run, name_there, points, below, n_ticks)
        track, lines = within_range(
            track, run.actuator(name_there), run.step_ns, accepts_beyond, below)
        tracks.append(track)
        limited += lines
    faults, others = (read_faults(tree.get(key, []), place / key, run, n_ticks)
                      for key in ('faults', 'changes'))
    if faults and others:
        _refuse_together((*faults, *others), run, f'{place}: faults and changes')
    return Scenario(name, run, n_ticks, tuple(tracks), figure_of(tree, place), accepts_beyond,
                    tuple(limited), (*faults, *others))


def _refuse_robots(tree: Tree, run: RunConfig, place: Place) -> None:
    """Refuse robots that the run does not have."""
    robots = [*dict.fromkeys(filter(None, (parted(own.name)[0] for own in run.actuators)))]
    for name in section_at(tree.get(ROBOTS, {}), place / ROBOTS):
        if name not in robots:
            known = alternatives(name, robots) if robots else 'it has no robots'
            raise ConfigError(f'{place / ROBOTS / name} is not a robot of {run.source}; {known}')


def _refuse_together(faults: Sequence[Fault], run: RunConfig, what: str) -> None:
    try:
        refuse_changes(faults, run)
    except ConfigError as error:
        raise ConfigError(f'{what}: {error}') from error


def _accepts_beyond(tree: Tree, place: Place) -> bool:
    if BEYOND not in tree:
        return False
    check(str(place / BEYOND), tree[BEYOND], {'names': (ACCEPT,)})
    return True


def _duration(value: Any, step_ns: int, where: str) -> int:
    check(where, value, {
        'doc': 'duration', 'unit': 's', 'bounds': {'gt': 0.0, 'le': MAX_DURATION}})
    n_ticks = ticks_in(float(value), step_ns, where)
    if n_ticks < 1:
        raise ConfigError(f'{where} = {value:g} s, must be >= step_ms = {step_ns / 1e6:g} ms')
    return n_ticks
