"""Extreme values of the signals of a run, as recorded."""

from isa_ros.analysis.report.circuit_panels import circuit_signals
from isa_ros.analysis.report.ground import upward_forces
from isa_ros.analysis.signals.signals import Signals
from isa_ros.config.runs.supplies import GAS, OIL, PRESSURE
from isa_ros.core.units import MPA
import numpy as np

_OF_CIRCUIT = {PRESSURE: ('pressure', MPA, 'MPa gauge'),
               GAS: ('gas temperature', 1.0, 'celsius'),
               OIL: ('oil temperature', 1.0, 'celsius')}
HEADER = ('signal', 'least', 'greatest', 'unit')


def extremes(signals: Signals) -> list[tuple[str, float, float, str]]:
    """Return (signal, least, greatest, unit) of actuators, circuits and ground, as recorded."""
    values = []
    for actuator in signals.run.actuators:
        name = actuator.name
        pressures = [signals.drawn(f'{name}.pressure_{side}').values / MPA for side in 'ab']
        for signal, series, unit in (
                *((field, signals[f'{name}.{field}'], signals.unit(f'{name}.{field}'))
                  for field in ('position', 'force') if f'{name}.{field}' in signals),
                ('pressure', np.concatenate(pressures), 'MPa gauge')):
            if len(series):
                values.append((f'{name} {signal}', float(series.min()), float(series.max()), unit))
        cushion = signals.drawn(f'{name}.cushion_pressure').values / MPA
        if cushion.any():
            values.append((f'{name} cushion pressure', 0.0, float(cushion.max()), 'MPa gauge'))
    for supply in signals.run.supplies:
        for name, recorded in circuit_signals(supply, signals).items():
            part, _, field = name.rpartition('.')
            what, scale, unit = _OF_CIRCUIT[field]
            series = recorded.values / scale
            values.append((
                f'{part} {what}', float(series.min()), float(series.max()), unit))
    for name, force in upward_forces(signals):
        values.append((f'{name} force upwards', float(force.min()), float(force.max()), 'N'))
    return values


def extreme_rows(signals: Signals) -> list[tuple[str, ...]]:
    """Return the rows of a table, the header first."""
    return [HEADER, *((signal, f'{least:.4g}', f'{greatest:.4g}', unit)
                      for signal, least, greatest, unit in extremes(signals))]
