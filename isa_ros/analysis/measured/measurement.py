"""A measurement in SI over its own time, read by a mapping from a CSV file or any bag."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from isa_ros.analysis.measured.bag_file import is_bag, read_fields
from isa_ros.analysis.measured.csv_file import Floats, read_columns
from isa_ros.analysis.measured.mapping import (
    MappedSignal, MeasurementMapping, PLACE, VELOCITY)
from isa_ros.analysis.measured.quantities import QUANTITIES, scale_of
from isa_ros.analysis.measured.slope import slope_of
from isa_ros.analysis.signals.signals import Signal
from isa_ros.errors import BagError, ConfigError
import numpy as np

_LONGEST_GAP_S = 1.0
_LONGEST_GAP_STEPS = 100.0
"""Longest gap between two samples: the longer of a time and of a number of median steps."""


class Measurement(NamedTuple):
    """Signals by quantity: t in s from the first sample, (n,), values in SI, (n,)."""

    name: str
    signals: Mapping[str, Signal]
    remark: str = ''
    """What was made from them otherwise than the mapping lets expect; '': nothing."""

    @property
    def times(self) -> Floats:
        """Return the times of the output with the most samples."""
        return max((own.t for own in self.outputs.values()), key=len)

    @property
    def commands(self) -> dict[str, Signal]:
        """Return the signals that commanded the machine."""
        return {name: own for name, own in self.signals.items() if QUANTITIES[name].mode}

    @property
    def outputs(self) -> dict[str, Signal]:
        """Return the others."""
        return {name: own for name, own in self.signals.items() if not QUANTITIES[name].mode}


def read_measurement(path: Path, mapping: MeasurementMapping, is_rotary: bool) -> Measurement:
    """
    Return a measurement.

    Raises
    ------
    BagError
        The file cannot be read, its times do not rise or have a gap, or a time or value is not
        finite.
    ConfigError
        A column, topic, field or unit of the mapping is not there.

    """
    raw = _of_bag(path, mapping) if is_bag(path) else _of_csv(path, mapping)
    found = {}
    for name, (t, numbers) in raw.items():
        own = mapping.signals[name]
        scale = scale_of(own.unit, QUANTITIES[name], is_rotary, own.where)
        with np.errstate(over='ignore', invalid='ignore'):
            values = scale * (own.factor * numbers + own.offset)
        if not np.isfinite(values).all():
            k = int(np.argmin(np.isfinite(values)))
            raise BagError(f'{path}: {name}: sample {k + 1} is {numbers[k]:g}, in SI '
                           f'{values[k]:g}, must be finite')
        found[name] = Signal(
            _risen((t - own.delay) / (1.0 + mapping.clock), f'{path}: {name}'), values)
    remark = ''
    if mapping.has_slope:
        if len(found[PLACE].t) < 2:
            raise BagError(f'{path}: {PLACE}: has one sample, must have two for a slope')
        slope = slope_of(found[PLACE])
        found[VELOCITY], remark = slope.signal, slope.remark(VELOCITY, PLACE)
    measurement = Measurement(path.name, found, remark)
    _refuse_gaps(path, measurement)
    return measurement


def _risen(t: Floats, where: str) -> Floats:
    """Return times in s, (n,), that are finite and rise."""
    if not np.isfinite(t).all():
        k = int(np.argmin(np.isfinite(t)))
        raise BagError(f'{where}: the time of sample {k + 1} is {t[k]:g} s, must be finite')
    rises = t[1:] > t[:-1]
    if not rises.all():
        k = int(np.argmin(rises))
        raise BagError(f'{where}: the time does not rise after sample {k + 1}, t = {t[k]:g} s')
    return t


def _refuse_gaps(path: Path, measurement: Measurement) -> None:
    """
    Refuse a gap in the times of an output, which none of its samples tell about.

    A command holds until the next one: it may pause as long as outputs go on.
    """
    outputs = [own.t for own in measurement.outputs.values()]
    for name, own in measurement.signals.items():
        t = np.unique(np.concatenate([own.t, *outputs])) if name in measurement.commands else own.t
        if len(t) < 2:
            continue
        steps = np.diff(t)
        k, usual = int(np.argmax(steps)), float(np.median(steps))
        longest = max(_LONGEST_GAP_S, _LONGEST_GAP_STEPS * usual)
        if steps[k] > longest:
            raise BagError(
                f'{path}: {name}: a gap of {steps[k]:g} s after t = {t[k]:g} s, must be <= '
                f'{longest:g} s with steps of {usual:g} s')


def _of_csv(path: Path, mapping: MeasurementMapping) -> dict[str, tuple[Floats, Floats]]:
    columns = {name: _column(own) for name, own in mapping.signals.items()}
    if mapping.time is None and mapping.rate is None:
        raise ConfigError(f'{mapping.name}: lacks time, either column and unit or rate_hz')
    wanted = [*columns.values(), *([] if mapping.time is None else [mapping.time])]
    found = read_columns(path, wanted, mapping.skip_lines, mapping.name)
    n = len(found[wanted[0]])
    if mapping.time is None:
        with np.errstate(over='ignore'):
            t = np.arange(n) / (mapping.rate or 1.0)
    else:
        with np.errstate(over='ignore', invalid='ignore'):
            t = (found[mapping.time] - found[mapping.time][0]) * mapping.time_scale
    return {name: (t, found[column]) for name, column in columns.items()}


def _column(own: MappedSignal) -> str | int:
    if own.source.column is None:
        raise ConfigError(f'{own.where}: lacks column, the measurement is a CSV file')
    return own.source.column


def _of_bag(path: Path, mapping: MeasurementMapping) -> dict[str, tuple[Floats, Floats]]:
    wanted: dict[str, list[str]] = {}
    for own in mapping.signals.values():
        if not own.source.topic:
            raise ConfigError(f'{own.where}: lacks topic and field, the measurement is a bag')
        wanted.setdefault(own.source.topic, []).append(own.source.field)
    found = read_fields(path, wanted)
    return {name: found[f'{own.source.topic} {own.source.field}']
            for name, own in mapping.signals.items()}
