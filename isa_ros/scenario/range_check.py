"""
Setpoints of a scenario beyond the range of their actuator: refused, limited or accepted.

They are checked when the scenario is read: with ``beyond_range: accept`` it takes setpoints as
they are, for an impedance that presses against a stop; otherwise the actuator's own key
``beyond_range`` refuses or limits them.
"""

from collections.abc import Iterator
from dataclasses import replace

from isa_ros.actuator.setpoint_range import Beyond, SetpointRange
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.sections import Place
from isa_ros.core.parameter import check
from isa_ros.core.signals import COMMAND
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.track import motion_key, Track, TrackEvent
import numpy as np

ACCEPT = 'accept'
"""Value of a scenario's key ``beyond_range``."""


def within_range(
        track: Track, actuator: ActuatorConfig, step_ns: int, accepts: bool,
        place: Place) -> tuple[Track, tuple[str, ...]]:
    """
    Return a track that stays within the range of its actuator, and lines on what is limited.

    ``accepts``: the scenario takes setpoints as they are. ``place`` is that of the track in its
    file.

    Raises
    ------
    ConfigError
        A setpoint is beyond the range, and the actuator does not limit it; or it is accepted,
        and more than a stroke beyond.

    """
    own = SetpointRange(actuator.name, actuator.sheet, actuator.beyond_range)
    if accepts or 'position' not in own.bounds:
        _refuse_far(track, actuator, place)
    if accepts:
        return track, ()
    events, lines = [], []
    for k, event in enumerate(track.events):
        following = track.events[k + 1].tick if k + 1 < len(track.events) else None
        text = next(_texts(event, following, own, step_ns, f'{place}[{k}]'), '')
        lines += [text] if text else []
        events.append(replace(event, limits=own) if text else event)
    return replace(track, events=tuple(events)), tuple(lines)


def _refuse_far(track: Track, actuator: ActuatorConfig, place: Place) -> None:
    """Refuse an equilibrium more than a stroke beyond the range: most likely a wrong unit."""
    if actuator.sheet.is_endless:
        return
    stroke = actuator.sheet.plant.drive.stroke
    for k, event in enumerate(track.events):
        if event.setpoint is not None:
            check(f'{place}[{k}].position', event.setpoint.position, {
                'doc': 'at most a stroke beyond the range',
                'unit': 'rad' if actuator.sheet.is_rotary else 'm',
                'bounds': {'ge': -stroke, 'le': 2.0 * stroke}})


def _texts(event: TrackEvent, following: int | None, own: SetpointRange, step_ns: int,
           where: str) -> Iterator[str]:
    """
    Return a line for each value of an event that is limited.

    A motion is followed to the next event, that of the last one to the extremes it ever has: the
    run may be longer than the scenario.
    """
    if event.setpoint is None and not event.has_gains:
        return
    if event.motion is None:
        for found in _beyond(event, event.tick, own, step_ns):
            yield _text(f'{where}.{found.shown}', found, own)
        return
    key = f'{where}.{motion_key(event.motion)}'
    extremes = [*_beyond_ever(event, own)]
    if following is None or not extremes:
        for found in extremes:
            yield _text(f'{key}: {found.shown}', found, own)
        return
    for tick in range(event.tick, following):
        for found in _beyond(event, tick, own, step_ns):
            t = tick * step_ns / NS_PER_SECOND
            yield _text(f'{key}: {found.shown} at t = {t:g} s', found, own)


def _beyond(event: TrackEvent, tick: int, own: SetpointRange, step_ns: int) -> Iterator[Beyond]:
    row = np.zeros(1, COMMAND)[0]
    event.write(tick, step_ns, row)
    return own.beyond(row)


def _beyond_ever(event: TrackEvent, own: SetpointRange) -> Iterator[Beyond]:
    """Return what leaves its range at the extremes of an event's motion."""
    assert event.setpoint is not None and event.motion is not None
    for excursion in event.motion.reach():
        row = np.zeros(1, COMMAND)[0]
        event.write_setpoint(excursion, row)
        yield from own.beyond(row)


def _text(what: str, found: Beyond, own: SetpointRange) -> str:
    if own.limits:
        return f'{what}, {found.limitation}'
    raise ConfigError(
        f'{what}, {found.refusal}; beyond_range: {ACCEPT} of the scenario takes it as it is, '
        'limit of the actuator limits it')
