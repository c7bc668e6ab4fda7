"""
`isa identify`: valve gains, bulk modulus, leakage and friction from a bag.

Each has its 95 % interval beside the value of the configuration in the bag. A parameter that
the data do not determine is refused with the reason.
"""

from dataclasses import asdict, replace
import math
from pathlib import Path
from typing import Any

from isa_ros.analysis.identification import force_balance
from isa_ros.analysis.identification.estimation import CONFIDENCE
from isa_ros.analysis.identification.flow_curves import DualGainCurve, FlowCurve, HighResponseCurve
from isa_ros.analysis.identification.force_balance import fit_friction
from isa_ros.analysis.identification.volume_balance import (
    C_LI, COMPLIANCE, CURVE, fit_balance, Q_0)
from isa_ros.analysis.signals.recording import Recording, recording_of, SHORTEST
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.core.frozen import frozen
from isa_ros.core.units import LPM, MILLI
from isa_ros.errors import BagError
from isa_ros.plant.hose_sheets import LumpedHoses
from isa_ros.plant.plant import LinearPlant, Plant
from isa_ros.plant.valve_sheets import DataSheetValve, DualGainValve, HighResponseValve
from isa_ros.text.table import aligned, GAP
import numpy as np

_LEAST_COUNTS = 50.0  # of the encoder; fewer leave more than 1 % of the volume to its rounding
_WIDEST = 0.5         # half of an interval over the estimate, beyond which none is given
_TOO_SHORT = 'too short: {:.2g} s of the bag can be used'
_UNSEPARATED = 'the data do not separate it from the others'
_WITHIN = 'not in the data: the spool stays near null'
_DATA_SHEET = 'not estimated with the flow curve of a data sheet'
_HOSES = 'not estimated behind hoses: the sensors read the pressures at the valve'
_SLIDING = 'not in the data: too little sliding both ways'
_SLOW = 'not in the data: no slow sliding that shows it'

_CurveRow = tuple[str, str, int, float, float]


@frozen
class Estimate:
    """One parameter: its estimate and 95 % interval, or why there is none."""

    parameter: str
    unit: str
    value: float | None
    low: float | None
    high: float | None
    configured: float
    reason: str
    """Empty if there is an estimate."""

    @property
    def holds(self) -> bool:
        """Return whether the interval contains the configured value."""
        return (self.low is not None and self.high is not None
                and self.low <= self.configured <= self.high)


@frozen
class Identified:
    """The estimates of actuators, and why there are none of the others."""

    actuators: dict[str, list[Estimate]]
    others: dict[str, str]


def identify_bag(bag: Path, actuator: str | None = None) -> Identified:
    """
    Return the estimates of every actuator of a bag, or of one.

    Raises
    ------
    BagError
        The bag cannot be read, or no actuator moved enough.
    ConfigError
        The bag has no actuator of this name.

    """
    signals = read_signals(bag)
    run = signals.run
    found = Identified({}, {})
    for one in [run.actuator(actuator)] if actuator else run.actuators:
        recording = recording_of(signals, one, bag)
        moved = float(np.ptp(recording.position))
        least = float(_LEAST_COUNTS * recording.plant.sensors.encoder)
        if moved < least:
            unit = 'rad' if one.sheet.is_rotary else 'm'
            found.others[one.name] = f'moved {moved:.2g} {unit}, needs at least {least:.2g} {unit}'
            continue
        found.actuators[one.name] = identify(recording, one.sheet.plant)
    if not found.actuators:
        raise BagError(f'{bag}: nothing to identify: ' + '; '.join(
            f'{name} {why}' for name, why in found.others.items()))
    return found


def identify(recording: Recording, sheet: Plant) -> list[Estimate]:
    """
    Return the estimates of one actuator beside the values of its sheet.

    With the flow curve of a data sheet, which has no few parameters, those of the friction; behind
    hoses, where the sensors read other pressures than those of the chambers, none.
    """
    if isinstance(sheet.valve, DataSheetValve):
        oil = sheet.oil
        valve_and_oil = [
            Estimate(name, unit, None, None, None, configured, _DATA_SHEET)
            for name, unit, configured in (
                ('bulk modulus', 'Pa', oil.effective_bulk_modulus),
                ('cross-port leakage', 'm3/s/Pa', oil.cross_port_leakage))]
    else:
        valve_and_oil = _valve_and_oil(recording, sheet)
    rows = [*valve_and_oil, *_friction(recording, sheet)]
    if isinstance(sheet.hoses, LumpedHoses):
        rows = [replace(row, value=None, low=None, high=None, reason=_HOSES) for row in rows]
    return rows


def _valve_and_oil(
        recording: Recording, sheet: Plant) -> list[Estimate]:
    valve, oil = sheet.valve, sheet.oil
    assert not isinstance(valve, DataSheetValve)  # as `identify` has it
    curve, names = _curve(recording, valve)
    balance = fit_balance(recording, curve)
    lacks = _TOO_SHORT.format(balance.duration) if balance.duration < SHORTEST else _UNSEPARATED
    rows = [
        _estimate(name, unit, balance.values[CURVE + k] / scale,
                  balance.half_widths[CURVE + k] / scale, configured,
                  lacks if k == 0 or balance.duration < SHORTEST else _WITHIN)
        for name, unit, k, scale, configured in names]
    rows.append(_inverse(_estimate(
        'bulk modulus', 'Pa', balance.values[COMPLIANCE], balance.half_widths[COMPLIANCE],
        1.0 / oil.effective_bulk_modulus, lacks)))
    rows += [
        _estimate(name, unit, balance.values[k] / scale, balance.half_widths[k] / scale,
                  configured, lacks)
        for name, unit, k, scale, configured in (
            ('cross-port leakage', 'm3/s/Pa', C_LI, 1.0, oil.cross_port_leakage),
            ('null leakage', 'l/min', Q_0, LPM, valve.null_leakage_lpm))]
    return rows


def _curve(
        recording: Recording, valve: DualGainValve | HighResponseValve
        ) -> tuple[FlowCurve, list[_CurveRow]]:
    """Return the flow curve, and (name, unit, k, SI per unit, configured) of its parameters."""
    si = recording.plant.valve
    per_ma = LPM / (valve.spool_gain_mm_per_ma * MILLI)  # m3/s per m of a l/min per mA
    if isinstance(valve, DualGainValve):
        return DualGainCurve(si.x_dg), [
            ('low flow gain', 'l/min/mA', 0, per_ma, valve.low_gain_lpm_per_ma),
            ('low flow gain', 'm3/s/m', 0, 1.0, float(si.k_low)),
            ('high flow gain', 'l/min/mA', 1, per_ma, valve.high_gain_lpm_per_ma),
            ('high flow gain', 'm3/s/m', 1, 1.0, float(si.k_high)),
            ('dual-gain point', 'mm', 2, MILLI, valve.dual_gain_point_mm)]
    return HighResponseCurve(si.x_dg), [
        ('flow gain', 'l/min/mA', 0, per_ma, valve.gain_lpm_per_ma),
        ('flow gain', 'm3/s/m', 0, 1.0, float(si.k_low)),
        ('flow beyond the knee', 'l/min', 1, LPM, valve.remaining_lpm)]


def _friction(recording: Recording, sheet: Plant) -> list[Estimate]:
    fit = fit_friction(recording)
    friction = sheet.friction
    force, speed, drag = (
        ('N', 'm/s', 'Ns/m') if isinstance(sheet, LinearPlant) else ('Nm', 'rad/s', 'Nms/rad'))
    return [
        _estimate(name, unit, fit.values[k], fit.half_widths[k], configured, reason)
        for name, unit, k, configured, reason in (
            ('Coulomb friction', force, force_balance.COULOMB, friction.coulomb, _SLIDING),
            ('viscous friction', drag, force_balance.VISCOUS, friction.viscous, _SLIDING),
            ('stiction', force, force_balance.STICTION, friction.stiction, _SLOW),
            ('Stribeck speed', speed, force_balance.STRIBECK, friction.stribeck_speed, _SLOW))]


def _estimate(
        name: str, unit: str, value: float, half_width: float, configured: float,
        reason: str) -> Estimate:
    """Return an estimate or its refusal; ``reason`` is given if it is not in the data."""
    value, half_width = float(value), float(half_width)
    if math.isnan(value) or math.isinf(half_width):
        return Estimate(name, unit, None, None, None, configured, reason)
    low, high = value - half_width, value + half_width
    if half_width <= _WIDEST * abs(value):
        return Estimate(name, unit, value, low, high, configured, '')
    return Estimate(
        name, unit, None, low, high, configured, f'too uncertain: {value:.3g} +- {half_width:.2g}')


def _inverse(estimate: Estimate) -> Estimate:
    """Return the estimate of the inverse of a parameter."""
    value, low, high = estimate.value, estimate.low, estimate.high
    if value is None or low is None or high is None:
        return Estimate(
            estimate.parameter, estimate.unit, None, None, None, 1.0 / estimate.configured,
            estimate.reason if low is None else 'too uncertain, its inverse may be 0')
    return Estimate(
        estimate.parameter, estimate.unit, 1.0 / value, 1.0 / high, 1.0 / low,
        1.0 / estimate.configured, '')


def table(found: Identified) -> str:
    """Return the estimates as text."""
    lines = []
    for name, estimates in found.actuators.items():
        lines += [name, *(GAP + line for line in aligned([
            ('', 'estimate', f'{100.0 * CONFIDENCE:g} % interval', 'configured', 'unit', ''),
            *map(_cells, estimates)]))]
    lines += [f'{name}: nothing to identify: {why}' for name, why in found.others.items()]
    return '\n'.join(lines)


def _cells(estimate: Estimate) -> tuple[str, ...]:
    head, tail = estimate.parameter, (f'{estimate.configured:.5g}', estimate.unit)
    if estimate.value is None:
        return head, '-', '', *tail, estimate.reason
    interval = f'{estimate.low:.5g} to {estimate.high:.5g}'
    return head, f'{estimate.value:.5g}', interval, *tail, '' if estimate.holds else 'differs'


def as_tree(found: Identified, bag: Path) -> dict[str, Any]:
    """Return the estimates for JSON, null for a refused one."""
    return {
        'bag': bag.name, 'confidence': CONFIDENCE,
        'actuators': {name: [asdict(estimate) | {'holds': estimate.holds}
                             for estimate in estimates]
                      for name, estimates in found.actuators.items()},
        'still': found.others}
