"""
What happened in a run: trips, warnings, states, refusals, cavities, overpressure, and changes.

Found in the samples of a run in memory, and in what its bag has of them, by the same functions;
behind a link a bag has what has arrived.
"""

from collections.abc import Iterator, Mapping, Sequence
import re
from typing import NamedTuple

from isa_ros.actuator.request_range import REQUEST, request_told
from isa_ros.actuator.tunable import changing
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.changeable import Changeable, changeables
from isa_ros.core.conditions import conditions
from isa_ros.core.device import state_name
from isa_ros.core.signals import Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLILITRE, MPA, quantity
from isa_ros.text.table import digits
from isa_ros.tick.trips import counts_of, Trip, trips_of
from msg_adapters.device import reason_of
import numpy as np

TRIP, WARNING, STATE = 'trip', 'warning', 'state'
CHANGE, REFUSED, CAVITY, OVERPRESSURE = 'change', 'refused', 'cavity', 'overpressure'
PAGE = 'by the page, '
"""Begins the lines about setpoints of a page, `page_event`."""
_PAGE_EVENT = re.compile(
    rf'{PAGE}(?P<name>[^:]+): (?P<text>.+?)( before tick (?P<tick>[0-9]{{1,15}}))?')
PROOF = 1.5
"""Pressure of a cylinder's proof test over its rated one, assumed; less is no event."""
_DIGITS = 4
_GAP = 2        # ticks between two values of a waveform: at an extreme two are equal
SMALL = 1e-9
"""Cavities below it, m3, are not told of: 1 mm3."""
SETPOINTS, REQUESTS, LARGEST_CAVITY = 'unused_setpoints', 'refused_requests', 'largest_cavity'
NONE = {SETPOINTS: 0.0, REQUESTS: 0.0, LARGEST_CAVITY: SMALL}
"""Fields of a `SAMPLE` that grow, and the values up to which there is nothing to tell."""
_COUNTS = (SETPOINTS, REQUESTS)


class Event(NamedTuple):
    """Something that happened."""

    t_s: float
    """
    When: by the device's own time; of a count or cavity, of the first sample that has it.

    Where a bag does not say which sample that is, of the last that may be, and `what` says so.
    """
    source: str
    """The actuator, or the supply."""
    kind: str
    """`TRIP`, `WARNING`, `STATE`, `CHANGE`, `REFUSED`, `CAVITY` or `OVERPRESSURE`."""
    what: str


class Begin(NamedTuple):
    """The samples, by their ticks, of which one is the first with a count or cavity."""

    first: int
    last: int


class History(NamedTuple):
    """What events are found in; of a bag only the ticks at which the devices have messages."""

    ticks: Sequence[int]
    """Of the samples, ascending, (n,)."""
    samples: Records
    """`SAMPLE`, (n, n_actuators)."""
    tuned: Mapping[int, Mapping[int, Mapping[str, float]]] = {}
    """Changed parameters by sample, row and name."""
    tuned_supplies: Mapping[int, Mapping[str, float]] = {}
    """Those of the supplies, by sample and SUPPLY.KEY."""
    cushions: 'Mapping[int, Trapped]' = {}
    """Of the actuators with cushions, by row."""
    events: Mapping[int, Sequence[str]] = {}
    """Texts of the run's own events, by the tick before which they happened."""
    begins: Mapping[tuple[int, str], Begin] = {}
    """Where counts and cavities began, by row and field: those that ``ticks`` have too late."""


class Trapped(NamedTuple):
    """The pressure behind the spears of one actuator."""

    ticks: Sequence[int]
    """Of the samples that have it, ascending, (n,)."""
    pressures: np.ndarray
    """Pa gauge, (n,)."""


def page_event(told: str, tick: int) -> str:
    """Return the line about a page's setpoint, ACTUATOR: TEXT, which was sent before a tick."""
    return f'{PAGE}{told} before tick {tick}'


def trips_in(run: RunConfig, history: History) -> list[Trip]:
    """Return what tripped, in the order of time."""
    return trips_of(history.samples, [(own.name, own.sheet.is_rotary) for own in run.actuators])


def events_in(run: RunConfig, history: History) -> list[Event]:
    """Return what happened after the first sample, in the order of time."""
    found = [*_changes(run, history), *_of_requests(history, run.step_ns)]
    found += (Event(own.t_s, own.actuator, TRIP, own.what) for own in trips_in(run, history))
    if len(history.ticks):
        for row, actuator in enumerate(run.actuators):
            samples = history.samples[:, row]
            found += _of_device(actuator.name, samples)
            begins = {field: _begin(history, row, field) for field in NONE}
            found += _of_counts(actuator.name, samples[-1:], begins, run.step_ns)
            found += _of_cavity(actuator.name, samples, begins[LARGEST_CAVITY], run.step_ns)
    for row, trapped in history.cushions.items():
        found += _of_cushion(run.actuators[row], trapped, run.step_ns)
    return sorted(found, key=lambda own: round(own.t_s * NS_PER_SECOND))


def _of_requests(history: History, step_ns: int) -> Iterator[Event]:
    """Yield requests of controllers that were refused or limited, and setpoints of a page."""
    for tick, texts in history.events.items():
        for name, text, is_refused in filter(None, map(request_told, texts)):
            yield Event(tick * step_ns / NS_PER_SECOND, name,
                        REFUSED if is_refused else WARNING, f'{REQUEST}{text}')
        for line in texts:
            if (found := _PAGE_EVENT.fullmatch(line)) is not None:
                first = tick if found['tick'] is None else int(found['tick'])
                yield Event(first * step_ns / NS_PER_SECOND, found['name'], CHANGE,
                            f'{PAGE}{found["text"]}')


def _of_device(name: str, samples: Records) -> Iterator[Event]:
    """Yield new warnings and states of one actuator, its `SAMPLE` (n,)."""
    changed = (samples['warnings'][1:] != samples['warnings'][:-1]) | (
        samples['device_state'][1:] != samples['device_state'][:-1])
    for k in np.flatnonzero(changed) + 1:
        before, now = samples[k - 1], samples[k]
        t_s = float(now['state_since'])
        for condition in conditions(int(now['warnings']) & ~int(before['warnings'])):
            yield Event(t_s, name, WARNING, condition)
        if now['device_state'] != before['device_state']:
            yield Event(
                t_s, name, STATE, f'{state_name(now["device_state"])}: {reason_of(now)}')


def _begin(history: History, row: int, field: str) -> Begin:
    """Return where a count or cavity of an actuator began, if it did."""
    tick = _first(history.samples[:, row][field] > NONE[field], history.ticks)
    return history.begins.get((row, field), Begin(tick, tick))


def _of_counts(name: str, last: Records, begins: Mapping[str, Begin], step_ns: int
               ) -> Iterator[Event]:
    """Yield an event for each count that is not 0 in the last `SAMPLE`, (1,)."""
    for field in _COUNTS:
        alone = last.copy()
        for other in _COUNTS:
            if other != field:
                alone[other] = 0.0
        for line in counts_of([name], alone):
            yield _begun(begins[field], name, REFUSED, line.partition(': ')[2], step_ns)


def _of_cavity(name: str, samples: Records, begin: Begin, step_ns: int) -> Iterator[Event]:
    """Yield an event for the largest cavity, its `SAMPLE` (n,)."""
    largest = float(np.nanmax(samples[LARGEST_CAVITY]))
    if largest > NONE[LARGEST_CAVITY]:
        what = f'vapour in a chamber, at most {digits(largest / MILLILITRE, _DIGITS)} ml'
        yield _begun(begin, name, CAVITY, what, step_ns)


def _begun(begin: Begin, source: str, kind: str, what: str, step_ns: int) -> Event:
    """Return an event at its begin; with both bounds in words where that is not known."""
    first, last = (tick * step_ns / NS_PER_SECOND for tick in begin)
    if first < last:
        what += f', begun between t = {first:.6f} s and t = {last:.6f} s'
    return Event(last, source, kind, what)


def _of_cushion(actuator: ActuatorConfig, trapped: Trapped, step_ns: int) -> Iterator[Event]:
    """Yield an event if the trapped oil of an actuator is beyond the proof pressure."""
    proof = PROOF * actuator.sheet.plant.drive.rated_pressure_mpa * MPA
    most = float(np.max(trapped.pressures, initial=0.0))
    if most > proof:
        yield Event(
            _first(trapped.pressures > proof, trapped.ticks) * step_ns / NS_PER_SECOND,
            actuator.name, OVERPRESSURE,
            f'behind the spear of a cushion, at most {digits(most / MPA, _DIGITS)} MPa, more than '
            f'{digits(proof / MPA, _DIGITS)} MPa, {PROOF:g} times plant.drive.rated_pressure_mpa')


def _first(holds: np.ndarray, ticks: Sequence[int]) -> int:
    """Return the tick of the first sample for which something holds."""
    return ticks[int(np.argmax(holds))]


def _changes(run: RunConfig, history: History) -> Iterator[Event]:
    """Yield faults and other changes of parameters; one that goes on at every tick is one."""
    known: dict[str, Mapping[str, Changeable]] = {
        own.name: changing(own.sheet, own.load) for own in run.actuators}
    known |= {own.name: changeables(own.sheet) for own in run.supplies}
    names = [own.name for own in run.actuators]
    by_tick: dict[tuple[str, str], dict[int, float]] = {}
    for tick, rows in history.tuned.items():
        for row, values in rows.items():
            for key, value in values.items():
                by_tick.setdefault((names[row], key), {})[tick] = value
    for tick, values in history.tuned_supplies.items():
        for path, value in values.items():
            supply, _, key = path.partition('.')
            by_tick.setdefault((supply, key), {})[tick] = value
    for (source, key), found in by_tick.items():
        yield from _runs(source, key, found, known.get(source, {}).get(key), run.step_ns)


def _runs(source: str, key: str, values: Mapping[int, float], own: Changeable | None,
          step_ns: int) -> Iterator[Event]:
    """Yield the changes of one parameter, by sample; they took effect a tick before it."""
    shown = key if own is None else own.key

    def text_of(value: float) -> str:
        if own is None:
            return digits(value, _DIGITS)
        if own.words:
            return str(own.shown(value))
        return quantity(digits(value / own.scale, _DIGITS), own.keyed.unit)
    ticks = sorted(tick for tick in values if tick > 0)
    first = 0
    for k, tick in enumerate(ticks):
        if k + 1 < len(ticks) and ticks[k + 1] <= tick + _GAP:
            continue
        begins = ticks[first]
        text = f'{shown} = {text_of(values[begins])}'
        if tick > begins:
            text += (f', then at every tick until t = {(tick - 1) * step_ns / NS_PER_SECOND:.6f} '
                     f's: {text_of(values[tick])}')
        yield Event((begins - 1) * step_ns / NS_PER_SECOND, source, CHANGE, text)
        first = k + 1
