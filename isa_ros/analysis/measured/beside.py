"""Measurements where commands take bags: `isa compare` of signals, `isa identify`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from isa_ros.analysis.identification.identification import Identified, identify
from isa_ros.analysis.measured.against import actuator_of, fit_cells, FIT_HEADER
from isa_ros.analysis.measured.fit import Fit, fit
from isa_ros.analysis.measured.mapping import load_mapping, MeasurementMapping
from isa_ros.analysis.measured.measurement import Measurement, read_measurement
from isa_ros.analysis.measured.quantities import QUANTITIES
from isa_ros.analysis.signals.recording import Recording, SLOWEST_STEP
from isa_ros.analysis.signals.signals import read_signals, Signal
from isa_ros.bag.reader import Bag
from isa_ros.core.units import MPA
from isa_ros.errors import AnalysisError, ConfigError
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import Run
from isa_ros.surroundings.supply import ConstantSupply, SupplySheet
from isa_ros.text.table import aligned
import numpy as np

NEEDED = ('position', 'force', 'pressure_a', 'pressure_b', 'spool')
"""Quantities of `isa identify`; the pressure of a constant supply is that of the configuration."""


def fits_of(
        expected: Path, actual: Path, mappings: Sequence[Path]) -> dict[str, Fit | str]:
    """
    Return how the signals of one measurement follow those of another, by quantity.

    The first mapping is that of ``expected``, the last one that of ``actual``. A bag of isa_ros
    needs none: its signals are those of the mapping's actuator, or of its only one.

    Raises
    ------
    BagError, ConfigError
        A measurement cannot be read, or they have no quantity in common.

    """
    own = [load_mapping(path) for path in mappings]
    name = next((each.actuator for each in own if each.actuator), None)
    first, second = _signals(expected, own[0], name), _signals(actual, own[-1], name)
    common = [quantity for quantity in first if quantity in second]
    if not common:
        raise ConfigError(f'{expected} has {", ".join(first)}, {actual} has {", ".join(second)}: '
                          'nothing in common')
    found: dict[str, Fit | str] = {}
    for quantity in common:
        try:
            found[quantity] = fit(first[quantity], second[quantity])
        except AnalysisError as error:
            found[quantity] = str(error)
    return found


def _signals(
        path: Path, mapping: MeasurementMapping, name: str | None) -> Mapping[str, Signal]:
    """Return the signals of a measurement, or of a bag of isa_ros, by quantity."""
    if (path.is_dir() or path.suffix == '.mcap') and _is_own(path):
        signals = read_signals(path, needs_values=False)
        names = [own.name for own in signals.run.actuators]
        if name is None and len(names) != 1:
            raise ConfigError(f'{mapping.name}: lacks actuator, one of {", ".join(names)}')
        own = signals.run.actuator(name or names[0]).name
        return {quantity: signals.over_time(f'{own}.{row.field}')
                for quantity, row in QUANTITIES.items()
                if row.field and f'{own}.{row.field}' in signals}
    return read_measurement(path, mapping, mapping.is_rotary).signals


def _is_own(path: Path) -> bool:
    """Return whether isa_ros recorded a bag."""
    files = [path] if path.is_file() else sorted(path.glob('*.mcap'))
    return bool(files) and Bag(path).has_provenance


def fits_text(found: Mapping[str, Fit | str]) -> str:
    """Return the fits as a table."""
    return '\n'.join(['actual against expected; delay > 0: the actual one is later', *aligned(
        [FIT_HEADER, *(fit_cells(*row) for row in found.items())], 'lrrrrl')])


def fits_tree(found: Mapping[str, Fit | str]) -> dict[str, Any]:
    """Return the fits for JSON."""
    return {quantity: own if isinstance(own, str) else own._asdict()
            for quantity, own in found.items()}


def identify_measured(path: Path, mapping: Path, run: Run) -> Identified:
    """
    Return the estimates of `isa identify` from a measurement of the actuator of a run.

    Raises
    ------
    BagError, ConfigError
        The measurement cannot be read, or lacks a quantity.

    """
    own = load_mapping(mapping)
    name = actuator_of(run, own.actuator)
    sheet = run.configuration.actuator(name).sheet
    measurement = read_measurement(path, own, sheet.is_rotary)
    return Identified({name: identify(_recording(measurement, run, name), sheet.plant)}, {})


def _recording(measurement: Measurement, run: Run, name: str) -> Recording:
    """Return a measurement on one grid of time."""
    signals = measurement.signals
    lacking = [quantity for quantity in NEEDED if quantity not in signals]
    if lacking:
        raise ConfigError(f'{measurement.name}: lacks {", ".join(lacking)} for an identification; '
                          f'it needs {", ".join(NEEDED)}')
    step = max(float(np.median(np.diff(signals[quantity].t))) for quantity in NEEDED)
    if step > SLOWEST_STEP:
        raise ConfigError(f'{measurement.name}: sampled every {1e3 * step:g} ms, must be at least '
                          f'every {1e3 * SLOWEST_STEP:g} ms')
    begin = max(float(signals[quantity].t[0]) for quantity in NEEDED)
    end = min(float(signals[quantity].t[-1]) for quantity in NEEDED)
    grid = np.arange(begin, end, step)
    values = {quantity: np.interp(grid, signals[quantity].t, signals[quantity].values)
              for quantity in NEEDED}
    configuration = run.configuration
    supply = configuration.supply_of(name)
    pressure = (np.interp(grid, *signals['supply_pressure']) if 'supply_pressure' in signals
                else np.full(len(grid), _constant_pressure(supply, measurement.name)))
    return Recording(
        plant=plant_record(configuration.actuator(name).sheet.plant)[0], step=step,
        supply_pressure=pressure, return_pressure=supply.return_pressure_mpa * MPA, **values)


def _constant_pressure(supply: SupplySheet, name: str) -> float:
    """Return the pressure of a supply that keeps it, Pa."""
    if not isinstance(supply, ConstantSupply):
        raise ConfigError(f'{name}: lacks supply_pressure, which the supply does not keep')
    return supply.pressure_mpa * MPA
