"""
Reader of tracks: lists of setpoints in a scenario's file.

A point has the numbers that its mode uses: in mode force and further in an effort alone is one.
Its position is then that of the point before, at first the start of the actuator.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from isa_ros.actuator.setpoint_range import NUMBERS
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.parameter_sets import build, of_axis
from isa_ros.config.text.sections import Place, refuse_unknown, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.device import FORCE, MODES
from isa_ros.core.parameter import check
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import of_coordinate
from isa_ros.errors import ConfigError
from isa_ros.scenario.device_steps import mode_before, read_device_step
from isa_ros.scenario.keys import SETPOINT
from isa_ros.scenario.track import GAIT, ImpedanceSetpoint, MOTIONS, Track, TrackEvent
from isa_ros.scenario.trot_motion import read_gait
from isa_ros.scenario.waveforms import (
    EFFORT, MOVES, OF_SETPOINTS, POSITION, refuse_amplitude, SetpointMotion)

MAX_DURATION = 1e6  # s, a bound against typing errors
HOLD = 'hold'       # position: the start of the actuator

_GAINS: Mapping[str, Mapping[str, Any]] = {
    'stiffness': {'doc': 'gain', 'unit': 'N/m | Nm/rad', 'bounds': {'ge': 0.0, 'le': 1e9}},
    'damping': {'doc': 'gain', 'unit': 'Ns/m | Nms/rad', 'bounds': {'ge': 0.0, 'le': 1e9}},
}


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
    events: list[TrackEvent] = []
    actuator, step_ns = run.actuator(name), run.step_ns
    mode, position = mode_before(actuator), actuator.initial_position
    for k, point in enumerate(points):
        below = Place(place.file, f'{place.key}[{k}]')
        event = _event(section_at(point, below), below, run, actuator, mode, position)
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
        position = position if event.setpoint is None else event.setpoint.position
    return Track(name, tuple(events))


def _event(tree: Tree, place: Place, run: RunConfig, actuator: ActuatorConfig,
           mode: int, position: float) -> TrackEvent:
    """Return a point after one with this mode and position."""
    numbers = tuple(own.name for own in fields(ImpedanceSetpoint))
    refuse_unknown(tree, SETPOINT, place)
    if 't_s' not in tree:
        raise ConfigError(place.has('lacks t_s'))
    check(f'{place}.t_s', tree['t_s'], {
        'doc': 'time', 'unit': 's', 'bounds': {'ge': 0.0, 'le': MAX_DURATION}})
    tick = ticks_in(float(tree['t_s']), run.step_ns, f'{place}.t_s')  # type: ignore[arg-type]
    device = read_device_step(tree, place, actuator, mode)
    gains = {name: _gain(tree, name, place, actuator) for name in _GAINS}
    given = [name for name in tree if name in (*numbers, *MOTIONS)]
    setpoint = motion = None
    if given:
        _refuse_incomplete(tree, given, place, device.mode or mode)
        setpoint = _setpoint(tree, place, actuator, position)
        motion = _motion(tree, place, run, actuator, setpoint)
    elif not set(tree) - {'t_s'}:
        raise ConfigError(
            place.has('needs a setpoint, or a key of the device such as enabled or mode'))
    return TrackEvent(tick, setpoint, gains['stiffness'], gains['damping'], motion, device)


def _refuse_incomplete(tree: Tree, given: list[str], place: Place, mode: int) -> None:
    """Refuse a point without the number that its mode needs; the others need not be given."""
    if 'position' in NUMBERS.get(mode, NUMBERS[FORCE]):
        missing = '' if POSITION in tree else f'position (or {HOLD!r})'
    elif EFFORT in tree or MODES[mode] in tree or (POSITION in tree and _moves_effort(tree)):
        missing = ''
    else:
        missing = EFFORT if mode == FORCE else f'{MODES[mode]}, or the {EFFORT}'
    if missing:
        raise ConfigError(
            f'{place}.{given[0]} is not enough: mode {MODES[mode]} needs the {missing}')


def _moves_effort(tree: Tree) -> bool:
    sections = [tree[name] for name in OF_SETPOINTS if name in tree]
    return any(isinstance(own, dict) and own.get(MOVES) == EFFORT for own in sections)


def _motion(tree: Tree, place: Place, run: RunConfig, actuator: ActuatorConfig,
            setpoint: ImpedanceSetpoint) -> SetpointMotion | None:
    given = [name for name in MOTIONS if name in tree]
    if not given:
        return None
    if len(given) > 1:
        raise ConfigError(place.has(f'has {" and ".join(given)}, must be one motion'))
    below = place / given[0]
    section = section_at(tree[given[0]], below)
    moves = POSITION if given[0] == GAIT else section.get(MOVES, POSITION)
    if moves == POSITION and POSITION not in tree:
        raise ConfigError(
            f'{below} is not used: it moves the position, which the setpoint does not have')
    if given[0] == GAIT:
        body = run.body_of(actuator.name)
        return read_gait(section, below, actuator, body if isinstance(body, LegConfig) else None,
                         setpoint.position)
    refuse_amplitude(section, str(below), actuator.sheet.is_rotary)
    with_default: Tree = {MOVES: POSITION}
    with_default |= section
    wave = build(OF_SETPOINTS[given[0]], written(with_default, below), below)
    wave.refuse_step(run.step_ns, str(below))
    return wave


def _setpoint(tree: Tree, place: Place, actuator: ActuatorConfig,
              position: float) -> ImpedanceSetpoint:
    """Return the setpoint of a point; ``position`` is that of one without."""
    given: Tree = {'position': position, 'velocity': 0.0, 'effort': 0.0}
    given.update({f.name: tree[f.name] for f in fields(ImpedanceSetpoint) if f.name in tree})
    if given['position'] == HOLD:
        given['position'] = actuator.initial_position
    elif isinstance(given['position'], str):
        unit = of_coordinate('m | rad', actuator.sheet.is_rotary)
        raise ConfigError(
            f'{place}.position = {given["position"]!r}, must be a number in {unit}, or {HOLD}')
    return build(ImpedanceSetpoint, written(given, place), place, actuator.sheet.is_rotary)


def _gain(tree: Tree, name: str, place: Place, actuator: ActuatorConfig) -> float | None:
    if name not in tree:
        return None
    check(f'{place}.{name}', tree[name], of_axis(_GAINS[name], actuator.sheet.is_rotary))
    return float(tree[name])  # type: ignore[arg-type]
