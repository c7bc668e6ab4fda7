"""`isa against`: a measured machine and the simulated one, with the same commands."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.actuator.ratings import ratings_of
from isa_ros.actuator.setpoint_range import setpoint_bounds
from isa_ros.analysis.measured.closing import (
    changed, CLOCK, Closed, closed, DELAY, delay_left, free_of, shifted, SHORTEST_S)
from isa_ros.analysis.measured.fit import Fit, fit
from isa_ros.analysis.measured.mapping import load_mapping, MeasurementMapping
from isa_ros.analysis.measured.measurement import Measurement, read_measurement
from isa_ros.analysis.measured.plausibility import (
    doubts_of_commands, doubts_of_fits, doubts_of_speed, doubts_of_time)
from isa_ros.analysis.measured.playback import LONGEST_S, played, prepared, remark
from isa_ros.analysis.measured.quantities import QUANTITIES
from isa_ros.analysis.signals.signals import Signal
from isa_ros.core.units import MILLI, of_coordinate
from isa_ros.errors import AnalysisError, ConfigError
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import Run
from isa_ros.text.table import aligned, digits

NONE = 'none'
"""The word for no free parameters."""


class Against(NamedTuple):
    """Both machines, and what would bring them together."""

    name: str
    is_rotary: bool
    measured: Mapping[str, Signal]
    """By quantity; after `closed` by its clock and delay."""
    simulated: Mapping[str, Signal]
    fits: Mapping[str, Fit | str]
    """By quantity; a text says why there is none."""
    parameters: Sequence[Closed]
    improved: Mapping[str, Signal]
    """Simulated with the closed parameters; empty without free ones."""
    improved_fits: Mapping[str, Fit | str]
    late: Closed | None = None
    """The delay that the parameters make up for, if they do."""


def actuator_of(run: Run, wanted: str | None) -> str:
    """Return the actuator of a mapping, or the only one of a run."""
    if wanted is None and len(run.actuators) != 1:
        raise ConfigError(
            f'the mapping lacks actuator, one of {", ".join(run.actuators)}')
    name: str = run.configuration.actuator(wanted or run.actuators[0]).name
    return name


def against(
        path: Path, mapping: Path, run: Run, free: Sequence[str], duration: float | None = None,
        progress: Callable[[int], object] = lambda n: None,
        begun: Callable[[str], object] = lambda text: None) -> Against:
    """
    Return a measurement beside a simulation with its commands.

    ``free`` are keys as `free_of` has them, none for the usual ones, or the word `NONE`. ``begun``
    is told what is compared, and what of the mapping makes the simulation late, before it begins.

    Raises
    ------
    BagError, ConfigError
        The measurement, the mapping or a key is refused; nothing measured is simulated.

    """
    own = load_mapping(mapping)
    name = actuator_of(run, own.actuator)
    is_rotary = run.configuration.actuator(name).sheet.is_rotary
    measurement = read_measurement(path, own, is_rotary)
    if not measurement.outputs:
        raise ConfigError(f'{own.name}: has commands only, nothing to compare a simulation with')
    run = prepared(run, name, measurement)
    time = _time(measurement, duration, run.configuration.step_ns * 1e-9)
    begun(_what(measurement, time))
    for line in _doubts(run, name, measurement, own, time):
        begun(line)
    for line in filter(None, (measurement.remark, remark(run, name, measurement))):
        begun(line)
    simulated = played(run, name, measurement, time)
    fits = _fits(measurement.outputs, simulated)
    for line in doubts_of_fits(fits, own, is_rotary):
        begun(line)
    keys = [] if list(free) == [NONE] else free_of(run, name, free)
    if keys and time < SHORTEST_S:
        begun(f'{measurement.name}: {digits(time, 4)} s are too short for intervals, which need '
              f'{SHORTEST_S:g} s or more')
    found = closed(run, name, measurement, keys, time, progress) if keys else []
    values = {each.free.key: each.value for each in found}
    run = changed(run, name, values)
    improved = played(run, name, measurement, time) if found else {}
    moved = {quantity: shifted(signal, values) for quantity, signal in measurement.outputs.items()}
    by_clock = measurement._replace(signals={**measurement.commands, **moved})
    late = delay_left(run, name, by_clock, time) if (
        values.keys() - {CLOCK, DELAY} and DELAY not in values) else None
    return Against(
        name, is_rotary, moved, simulated, fits, found, improved, _fits(moved, improved), late)


def _doubts(
        run: Run, name: str, measurement: Measurement, mapping: MeasurementMapping,
        time: float) -> Iterator[str]:
    """Yield what speaks for a wrong unit before anything is simulated."""
    sheet = run.configuration.actuator(name).sheet
    yield from doubts_of_time(measurement, mapping)
    yield from doubts_of_commands(measurement, setpoint_bounds(sheet))
    yield from doubts_of_speed(
        measurement, time, ratings_of(plant_record(sheet.plant)[0]).speed,
        unit_of('velocity', sheet.is_rotary))


def _time(measurement: Measurement, duration: float | None, step: float) -> float:
    """Return the time to simulate, a whole number of ticks."""
    last = min(duration or LONGEST_S, max(
        float(own.t[-1]) for own in measurement.signals.values()))
    n = int(last / step)
    if n < 1 or last > LONGEST_S:
        raise ConfigError(f'{measurement.name}: lasts {last:g} s, must be {step:g} to '
                          f'{LONGEST_S:g} s; --duration takes a part of it')
    return n * step


def _what(measurement: Measurement, time: float) -> str:
    """Return how much is compared: its samples, their rate and the simulated time."""
    t = measurement.times
    span = float(t[-1] - t[0])
    rate = f' at {digits((len(t) - 1) / span, 4)} Hz' if span > 0.0 else ''
    return (f'{measurement.name}: {len(t)} samples, {digits(span, 4)} s{rate}; '
            f'{digits(time, 4)} s are compared')


def _fits(
        measured: Mapping[str, Signal], simulated: Mapping[str, Signal]
        ) -> dict[str, Fit | str]:
    found: dict[str, Fit | str] = {}
    for quantity, signal in simulated.items():
        try:
            found[quantity] = fit(measured[quantity], signal)
        except AnalysisError as error:
            found[quantity] = str(error)
    return found


def fit_cells(quantity: str, found: Fit | str) -> tuple[str, ...]:
    """Return the cells of a row about a signal."""
    if isinstance(found, str):
        return quantity, '-', '-', '-', '-', found
    return (quantity, digits(found.nrmse, 3), f'{found.delay / MILLI:.2f} ms',
            digits(found.gain, 4), digits(found.left, 3), _remark(found))


def _remark(found: Fit) -> str:
    """Return what keeps the numbers of a fit from meaning anything, '': nothing."""
    return 'no match: the delay is at the end of its search' if found.is_at_end else ''


FIT_HEADER = ('', 'NRMSE', 'delay', 'gain', 'left', '')


def as_text(found: Against) -> str:
    """Return the fits and the parameters as tables."""
    lines = [f'{found.name}, simulated against measured; delay > 0: the simulation is later',
             *aligned([FIT_HEADER, *(fit_cells(*row) for row in found.fits.items())], 'lrrrrl')]
    if found.parameters:
        lines += ['', 'parameters that close the gap', *aligned([
            ('', 'configured', 'estimate', '95 % interval', 'unit', ''),
            *(_cells(own, found.is_rotary) for own in found.parameters)], 'lrrlll'),
            '', 'with them', *aligned([FIT_HEADER, *(
                fit_cells(*row) for row in found.improved_fits.items())], 'lrrrrl')]
    if found.late:
        lines += ['', f'the parameters make up for a delay: {found.late.value:.2g} +- '
                  f'{found.late.half_width:.2g} ms of it are left; add --free {DELAY}']
    return '\n'.join(lines)


def _cells(own: Closed, is_rotary: bool) -> tuple[str, ...]:
    free = own.free
    head, unit = (free.key, f'{free.start:.5g}'), of_coordinate(free.unit, is_rotary)
    low, high = own.value - own.half_width, own.value + own.half_width
    if not own.is_determined:
        return *head, '-', '', unit, f'not determined: {own.value:.3g} +- {own.half_width:.2g}'
    at_bound = own.value <= free.low * 1.001 or own.value >= free.high * 0.999
    return (*head, f'{own.value:.5g}', f'{low:.5g} to {high:.5g}', unit,
            'at its bound' if at_bound and free.low >= 0.0 else '')


def as_tree(found: Against, path: Path) -> dict[str, Any]:
    """Return the numbers for JSON, null where there are none."""
    def of(fits: Mapping[str, Fit | str]) -> dict[str, Any]:
        return {quantity: own if isinstance(own, str) else own._asdict()
                for quantity, own in fits.items()}
    return {
        'measurement': path.name, 'actuator': found.name, 'fits': of(found.fits),
        'parameters': [own.free._asdict() | {
            'value': own.value, 'is_determined': own.is_determined,
            'half_width': own.half_width if own.half_width < float('inf') else None}
            for own in found.parameters],
        'closed': of(found.improved_fits),
        'delay_left_ms': found.late.value if found.late else None}


def unit_of(quantity: str, is_rotary: bool) -> str:
    """Return the SI unit of a quantity."""
    return of_coordinate(QUANTITIES[quantity].unit, is_rotary)
