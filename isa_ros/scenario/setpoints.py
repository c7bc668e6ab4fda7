"""Reader of tracks: lists of setpoints in a scenario's file."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, refuse_unknown, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.parameter import check
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.device_steps import (
    DEVICE_KEYS, DeviceStep, mode_before, read_device_step)
from isa_ros.scenario.track import GAIT, ImpedanceSetpoint, MOTIONS, Track, TrackEvent
from isa_ros.scenario.trot_motion import read_gait
from isa_ros.scenario.waveforms import MOVES, POSITION, SetpointMotion, WAVEFORMS

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


def _event(tree: Tree, place: Place, run: RunConfig, actuator: ActuatorConfig,
           mode: int) -> TrackEvent:
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
    return TrackEvent(tick, setpoint, gains['stiffness'], gains['damping'], motion, device)


def _motion(tree: Tree, place: Place, run: RunConfig, actuator: ActuatorConfig,
            setpoint: ImpedanceSetpoint) -> SetpointMotion | None:
    given = [name for name in MOTIONS if name in tree]
    if not given:
        return None
    if len(given) > 1:
        raise ConfigError(place.has(f'has {" and ".join(given)}, must be one motion'))
    below = place / given[0]
    section = section_at(tree[given[0]], below)
    if given[0] == GAIT:
        return read_gait(section, below, actuator, run.leg, setpoint.position)
    with_default: Tree = {MOVES: POSITION}
    with_default |= section
    wave = build(WAVEFORMS[given[0]], written(with_default, below), below)
    wave.refuse_step(run.step_ns, str(below))
    return wave


def _setpoint(tree: Tree, place: Place, actuator: ActuatorConfig) -> ImpedanceSetpoint:
    given: Tree = {'velocity': 0.0, 'effort': 0.0}
    given.update({f.name: tree[f.name] for f in fields(ImpedanceSetpoint) if f.name in tree})
    if given['position'] == HOLD:
        given['position'] = actuator.initial_position
    check(f'{place}.position', given['position'], {
        'doc': 'equilibrium', 'unit': 'rad' if actuator.sheet.is_rotary else 'm', 'bounds': {}})
    return build(ImpedanceSetpoint, written(given, place), place)


def _gain(tree: Tree, name: str, place: Place) -> float | None:
    if name not in tree:
        return None
    check(f'{place}.{name}', tree[name], _GAINS[name])
    return float(tree[name])  # type: ignore[arg-type]
