"""The verdict of a run in words: its end, trips, warnings, faults, limits, what has settled."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from isa_ros.analysis.report.key_figures import END, settling_time
from isa_ros.analysis.report.limits import reached_limits
from isa_ros.analysis.report.marks import Band
from isa_ros.analysis.signals.signals import LARGEST, Signal, Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.device import ENABLED, state_name
from isa_ros.core.suggest import listed
from isa_ros.run.events import CAVITY, CHANGE, Event, OVERPRESSURE, REFUSED, TRIP, WARNING
from isa_ros.text.table import digits
import numpy as np

GOOD, NOTE, BAD = 'good', 'note', 'bad'
_MOST = 6       # events of a kind that are told one by one
_RIPPLE = 0.01  # of the range of the force sensor: a larger swing after a motion is told
_PASSES = 4     # of its middle, from which on a force swings: two periods
_KINDS: Mapping[str, tuple[str, str]] = {
    TRIP: ('Tripped', BAD), WARNING: ('Warned', NOTE), CHANGE: ('Fault or change', NOTE),
    REFUSED: ('Refused', NOTE), CAVITY: ('Cavitated', NOTE), OVERPRESSURE: ('Overpressure', BAD)}
"""In the order of the verdict, with their word and whether they are bad."""
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
    """Yield which actuators stood still, settled, or still move at the end, and by what device."""
    words: dict[str, list[str]] = {}
    for own in signals.run.actuators:
        t, x = signals.drawn(f'{own.name}.position')
        if not len(t):
            continue
        settled = settling_time(t, x)
        word = ('Did not move' if np.ptp(x) == 0.0 else
                'Still moving at the end' if settled is None else
                _word_at_rest(own, bands))
        words.setdefault(word, []).append(
            own.name if settled is None else f'{own.name} at t = {settled:.3f} s')
    for word in sorted(words):
        is_good = word in ('Did not move', _SETTLED)
        yield Statement(GOOD if is_good else NOTE, f'{word}: {", ".join(words[word])}.')


def _word_at_rest(own: ActuatorConfig, bands: Sequence[Band]) -> str:
    """Return what is said of an actuator that came to rest; its device may be off at the end."""
    states = [band.state for band in bands if band.source == own.name]
    return (_SETTLED if not states or states[-1] == _ON else
            f'Came to rest, its device {states[-1]} at the end')


def _swings(signals: Signals) -> Iterator[Statement]:
    """Yield forces that go on to swing where the motion has ended, as those of loops that hunt."""
    for own in signals.run.actuators:
        t, x = signals.drawn(f'{own.name}.position')
        if not len(t):
            continue
        swing, is_blocked = 0.0, np.ptp(x) == 0.0
        if is_blocked or settling_time(t, x) is not None:
            swing = _swing(signals.drawn(f'{own.name}.force'))
        if is_blocked and _swing(signals.drawn(f'{own.name}.force_reference')) > 0.5 * swing:
            continue    # as it was wanted
        span = own.sheet.plant.sensors.force_range
        if swing > _RIPPLE * span:
            yield Statement(NOTE, (
                f'Force swings in the last tenth of the time: {own.name} by '
                f'+-{digits(swing, 3)} {signals.unit(f"{own.name}.force")}, '
                f'{100.0 * swing / span:.2g} % of the range of its sensor.'))


def _swing(signal: Signal) -> float:
    """
    Return half of peak to peak of a signal in the last tenth of the time; 0: it does not swing.

    A swing passes the middle between its extremes again and again, by half of its height on each
    side: a step or a drift is none, and neither is one pulse.
    """
    if not len(signal.t):
        return 0.0
    tail = signal.values[signal.t >= signal.t[-1] - END * (signal.t[-1] - signal.t[0])]
    tail = tail[np.isfinite(tail)]
    if not len(tail):
        return 0.0
    height = 0.5 * float(np.ptp(tail))
    from_middle = tail - (float(tail.min()) + height)
    sides = np.sign(from_middle[np.abs(from_middle) > 0.5 * height])
    return height if np.count_nonzero(np.diff(sides)) >= _PASSES else 0.0
