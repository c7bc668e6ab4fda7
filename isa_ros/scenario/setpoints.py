"""
Tracks: the setpoints of one actuator by tick, SI, with the names of the setpoint topic.

A missing velocity or effort is zero; a missing gain leaves the gain in force unchanged.
"""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, fields
import math
from typing import Any

from isa_ros.config.run_config import ActuatorConfig, RunConfig
from isa_ros.config.run_file import ticks_in
from isa_ros.config.sections import as_tree, build, Place, refuse_unknown, section_at, written
from isa_ros.config.yaml_text import Tree
from isa_ros.core.parameter import check, parameter, Parameters
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.device_steps import (
    DEVICE_KEYS, DeviceStep, mode_before, read_device_step)
from isa_ros.scenario.trot_motion import read_gait
from isa_ros.scenario.waveforms import Excursion, MAX_EFFORT, Motion, POSITION, WAVEFORMS
import numpy as np

GAIT = 'gait'
MOTIONS = (*WAVEFORMS, GAIT)
MAX_DURATION = 1e6  # s, a bound against typing errors
HOLD = 'hold'       # position: the start of the actuator


@dataclass(frozen=True, kw_only=True)
class Setpoint(Parameters):
    """One impedance setpoint, SI."""

    position: float = parameter('equilibrium', 'm | rad', ge=-100.0, le=100.0)
    velocity: float = parameter('of the equilibrium', 'm/s | rad/s', ge=-1e3, le=1e3)
    effort: float = parameter('feed-forward', 'N | Nm', ge=-MAX_EFFORT, le=MAX_EFFORT)


_GAINS: Mapping[str, Mapping[str, Any]] = {
    'stiffness': {'doc': 'gain', 'unit': 'N/m | Nm/rad', 'bounds': {'ge': 0.0, 'le': 1e9}},
    'damping': {'doc': 'gain', 'unit': 'Ns/m | Nms/rad', 'bounds': {'ge': 0.0, 'le': 1e9}},
}


@dataclass(frozen=True)
class Event:
    """The command to one actuator at one tick; None leaves a value unchanged."""

    tick: int
    setpoint: Setpoint | None
    stiffness: float | None
    damping: float | None
    motion: Motion | None
    device: DeviceStep

    def write(self, tick: int, step_ns: int, row: np.void) -> None:
        """
        Fill the `COMMAND` row of ``tick``, this event's own or a later one of its motion.

        Values of the row that the event does not set are left unchanged.
        """
        kinds = 0
        if self.setpoint is not None:
            kinds = HAS_SETPOINT
            own = self.setpoint
            added = Excursion(0.0, 0.0, 0.0)
            if self.motion is not None:
                added = self.motion.at((tick - self.tick) * step_ns)
            row['position'] = own.position + added.position
            row['velocity'] = own.velocity + added.velocity
            row['effort'] = own.effort + added.effort
            for name in _GAINS:
                value = getattr(self, name)
                row[name] = math.nan if value is None else value
        row['kinds'] |= kinds
        if tick == self.tick:
            self.device.write(row)


@dataclass(frozen=True)
class Track:
    """The events of one actuator, in ascending order of time."""

    actuator: str
    events: tuple[Event, ...]

    def at(self, tick: int) -> Event | None:
        """Return the event of ``tick``, or the earlier one whose motion still runs."""
        k = bisect_right(self.events, tick, key=lambda event: event.tick) - 1
        if k < 0:
            return None
        event = self.events[k]
        return event if event.tick == tick or event.motion is not None else None


def read_track(run: RunConfig, name: str, points: Any, place: Place, n_ticks: int) -> Track:
    """
    Return the track of a list of setpoints for one actuator of a run.

    Raises
    ------
    ConfigError
        A setpoint is invalid, not on a tick, out of order or after the end.

    """
    if not isinstance(points, list) or not points:
        raise ConfigError(f'{place} = {points!r}, must be a list of setpoints')
    events: list[Event] = []
    step_ns, mode = run.step_ns, mode_before(run.actuator(name))
    for k, point in enumerate(points):
        below = Place(place.file, f'{place.key}[{k}]')
        event = _event(section_at(point, below), below, run, run.actuator(name), mode)
        if event.tick >= n_ticks:
            raise ConfigError(
                f'{below}.t_s = {event.tick * step_ns / NS_PER_SECOND:g} s, must be < '
                f'duration_s = {n_ticks * step_ns / NS_PER_SECOND:g} s')
        if events and event.tick <= events[-1].tick:
            raise ConfigError(
                f'{below}.t_s = {event.tick * step_ns / NS_PER_SECOND:g} s, must be > the '
                f'one before it, {events[-1].tick * step_ns / NS_PER_SECOND:g} s')
        events.append(event)
        mode = event.device.mode or mode
    return Track(name, tuple(events))


def _event(
        tree: Tree, place: Place, run: RunConfig, actuator: ActuatorConfig, mode: int) -> Event:
    refuse_unknown(tree, (
        't_s', 'position', 'velocity', 'effort', 'stiffness', 'damping', *DEVICE_KEYS, *MOTIONS),
        place)
    check(f'{place}.t_s', tree.get('t_s'), {
        'doc': 'time', 'unit': 's', 'bounds': {'ge': 0.0, 'le': MAX_DURATION}})
    tick = ticks_in(float(tree['t_s']), run.step_ns, f'{place}.t_s')  # type: ignore[arg-type]
    device = read_device_step(tree, place, actuator, mode)
    for name in set(tree) - {'t_s', 'position', *DEVICE_KEYS}:
        if 'position' not in tree:
            raise ConfigError(
                f'{place}.{name} is not used: a setpoint needs its position (or {HOLD!r})')
    if 'position' not in tree and device == DeviceStep():
        raise ConfigError(
            place.has('needs a position, or a key of the device such as enabled or mode'))
    gains = {name: _gain(tree, name, place) for name in _GAINS}
    setpoint = _setpoint(tree, place, actuator) if 'position' in tree else None
    motion = None if setpoint is None else _motion(tree, place, run, actuator, setpoint)
    return Event(tick, setpoint, gains['stiffness'], gains['damping'], motion, device)


def _motion(tree: Tree, place: Place, run: RunConfig, actuator: ActuatorConfig,
            setpoint: Setpoint) -> Motion | None:
    given = [name for name in MOTIONS if name in tree]
    if not given:
        return None
    if len(given) > 1:
        raise ConfigError(place.has(f'has {" and ".join(given)}, must be one motion'))
    below = place / given[0]
    section = section_at(tree[given[0]], below)
    if given[0] == GAIT:
        return read_gait(section, below, actuator, run.leg, setpoint.position)
    with_default: Tree = {'moves': POSITION}
    with_default |= section
    wave = build(WAVEFORMS[given[0]], written(with_default, below), below)
    wave.refuse_step(run.step_ns, str(below))
    return wave


def _setpoint(tree: Tree, place: Place, actuator: ActuatorConfig) -> Setpoint:
    given: Tree = {'velocity': 0.0, 'effort': 0.0}
    given.update({f.name: tree[f.name] for f in fields(Setpoint) if f.name in tree})
    if given['position'] == HOLD:
        given['position'] = actuator.initial_position
    _refuse_far(given['position'], place, actuator)
    return build(Setpoint, written(given, place), place)


def _gain(tree: Tree, name: str, place: Place) -> float | None:
    if name not in tree:
        return None
    check(f'{place}.{name}', tree[name], _GAINS[name])
    return float(tree[name])  # type: ignore[arg-type]


def _refuse_far(position: Any, place: Place, actuator: ActuatorConfig) -> None:
    """Refuse an equilibrium more than a stroke beyond the range: most likely a wrong unit."""
    stroke = actuator.sheet.plant.drive.stroke
    check(f'{place}.position', position, {
        'doc': 'at most a stroke beyond the range',
        'unit': 'rad' if actuator.sheet.is_rotary else 'm',
        'bounds': {'ge': -stroke, 'le': 2.0 * stroke}})


def event_tree(event: Event, step_ns: int) -> Tree:
    """Return an event as a scenario file has it, with its position as a number."""
    tree: Tree = {'t_s': event.tick * step_ns / NS_PER_SECOND}
    if event.setpoint is not None:
        tree |= as_tree(event.setpoint)
    for name in _GAINS:
        if getattr(event, name) is not None:
            tree[name] = getattr(event, name)
    tree |= event.device.tree()
    if event.motion is not None:
        tree[_kind(event.motion)] = event.motion.tree()
    return tree


def _kind(motion: Motion) -> str:
    """Return the key of a motion."""
    return next((name for name, cls in WAVEFORMS.items() if isinstance(motion, cls)), GAIT)
