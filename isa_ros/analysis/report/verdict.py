"""The verdict of a run in words: its end, trips, warnings, faults, limits, what has settled."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from isa_ros.analysis.report.key_figures import (
    end_of, error_of, SETTLED, settling_time, shown_position)
from isa_ros.analysis.report.limits import reached_limits
from isa_ros.analysis.report.marks import Band
from isa_ros.analysis.report.swings import stands, stood, swings
from isa_ros.analysis.signals.signals import LARGEST, Signal, Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.device import ENABLED, state_name
from isa_ros.core.suggest import listed
from isa_ros.loads.sheets import Blocked
from isa_ros.run.events import CAVITY, CHANGE, Event, OVERPRESSURE, REFUSED, TRIP, WARNING
from isa_ros.text.table import digits
import numpy as np

GOOD, NOTE, BAD = 'good', 'note', 'bad'
_MOST = 6       # events of a kind that are told one by one
_KINDS: Mapping[str, tuple[str, str]] = {
    TRIP: ('Tripped', BAD), WARNING: ('Warned', NOTE), CHANGE: ('Fault or change', NOTE),
    REFUSED: ('Not followed', NOTE), CAVITY: ('Cavitated', NOTE),
    OVERPRESSURE: ('Overpressure', BAD)}
"""In the order of the verdict, with their word and whether they are bad."""
_NEAR = 0.25        # of the range of a reference: who follows it is not farther from it
_ALIKE = 0.5        # of a motion, rms: who follows it moves no more differently
_MOVES = 'Moving at the end, as its reference'
_SETTLED, _ON = 'Settled', state_name(ENABLED)


class Statement(NamedTuple):
    """One line of the verdict."""

    grade: str
    """`GOOD`, `NOTE` or `BAD`."""
    text: str


def verdict(signals: Signals, events: Sequence[Event], bands: Sequence[Band], ending: str
            ) -> list[Statement]:
    """
    Return the statements about a run.

    ``bands`` are the states of its devices, ``ending`` is why it did not come to its end, or ''.
    """
    end = float(signals.time[-1])
    found = [Statement(BAD, ending) if ending else
             Statement(GOOD, f'The run came to its end, t = {end:.3f} s.')]
    if not any(own.kind == TRIP for own in events):
        found.append(Statement(GOOD, 'Nothing tripped.'))
    if signals.impossible:
        found.append(Statement(BAD, f'Not shown: samples beyond {LARGEST:g} of '
                                    f'{listed(signals.impossible)}.'))
    for kind, (word, grade) in _KINDS.items():
        found += _told(word, grade, [own for own in events if own.kind == kind])
    if signals.problem:
        return found
    limits = reached_limits(signals)
    found += [Statement(NOTE, f'Limit reached: {own}.') for own in limits]
    if not limits:
        found.append(Statement(GOOD, 'No loop, end stop or relief valve reached its limit.'))
    return [*found, *_motion(signals, bands), *_swings(signals)]


def _told(word: str, grade: str, events: Sequence[Event]) -> Iterator[Statement]:
    """Yield a statement for each event of a kind; of very many the first ones."""
    for own in events[:_MOST]:
        yield Statement(grade, f'{word}: {own.source}, {own.what}, t = {own.t_s:.6f} s.')
    if len(events) > _MOST:
        yield Statement(grade, f'{word}: {len(events) - _MOST} more, see the events.')


def _motion(signals: Signals, bands: Sequence[Band]) -> Iterator[Statement]:
    """Yield which actuators stood, settled, or still move at the end, and by what device."""
    words: dict[str, list[str]] = {}
    for own in signals.run.actuators:
        t, x = signals.drawn(f'{own.name}.position')
        if not len(t):
            continue
        settled, who = settling_time(t, x), own.name
        state = _off_at_end(own, bands)
        if np.ptp(x) == 0.0:
            word = 'Did not move' + ('' if state else _unheeded(signals, own))
        elif stood(own, x):
            word, (scale, unit) = f'Stood{state or _unheeded(signals, own)}', shown_position(own)
            who = f'{own.name} within {digits(scale * float(np.ptp(x)), 2)} {unit}'
        elif settled is not None:
            word = f'Came to rest{state}' if state else _SETTLED
            who = f'{own.name} at t = {settled:.3f} s'
        else:
            word = _MOVES if not state and _follows(signals, own) else 'Still moving at the end'
        words.setdefault(word, []).append(who)
    for word in sorted(words):
        is_good = word in ('Did not move', 'Stood', _SETTLED, _MOVES)
        yield Statement(GOOD if is_good else NOTE, f'{word}: {", ".join(words[word])}.')


def _follows(signals: Signals, own: ActuatorConfig) -> bool:
    """Return whether the reference moves in the last tenth of the time, and the position so."""
    error = error_of(signals, own.name, 'position')
    if error is None:
        return False
    reference = signals.drawn(f'{own.name}.position_reference')
    wanted, apart = end_of(reference).values, end_of(Signal(*error)).values
    span = np.ptp(reference.values)
    return bool(np.ptp(wanted) > SETTLED * span and np.abs(apart).max() < _NEAR * span
                and apart.std() < _ALIKE * wanted.std())


def _unheeded(signals: Signals, own: ActuatorConfig) -> str:
    """Return what is said of an actuator that stood, and could have moved as its reference."""
    reference = signals.drawn(f'{own.name}.position_reference').values
    can = len(reference) and not isinstance(own.load, Blocked)
    return ' while its reference moved' if can and not stands(own, reference) else ''


def _off_at_end(own: ActuatorConfig, bands: Sequence[Band]) -> str:
    """Return what is said of a device that is not enabled at the end, or ''."""
    states = [band.state for band in bands if band.source == own.name]
    return '' if not states or states[-1] == _ON else f', its device {states[-1]} at the end'


def _swings(signals: Signals) -> Iterator[Statement]:
    """Yield the forces that go on to swing."""
    for own in swings(signals):
        yield Statement(NOTE, (
            f'Force swings in the last tenth of the time: {own.actuator} by '
            f'+-{digits(own.size, 3)} {signals.unit(f"{own.actuator}.force")} at '
            f'{own.hertz:.3g} Hz, '
            f'{digits(100.0 * own.share, 2)} % of the range of its sensor.'))
