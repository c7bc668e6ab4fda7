"""
How well the model of a valve or motor fits its data sheet: each stated number, and the model's.

The lands are shut in as on a valve bench: flow at the rated drop without a load, leakage and load
pressure with both ports shut. Frequencies are those of the spool behind the coil's current.
"""

from collections.abc import Callable, Iterator
import math
from typing import NamedTuple

from isa_ros.core.units import LPM, MILLI, MPA, PERCENT
from isa_ros.plant.hysteresis import Hysteretic, passed_of_sine
from isa_ros.plant.motor import Motor
from isa_ros.plant.plant import MotorPlant, Plant, plant_record
from isa_ros.plant.response_fit import gain_at, leading, magnitude, response_at, SecondOrder
from isa_ros.plant.servo_valve import port_flows
from isa_ros.plant.spool import DataSheetSpool, ResponseSpool
from isa_ros.plant.stated_curves import SidesFlow
from isa_ros.plant.valve_sheets import DataSheetValve
import numpy as np

_HALVINGS = 60
_FINE = 400     # currents at which the largest leakage is looked for
_GAIN = math.sqrt(0.5)
_SMALL = 5.0    # % of the current: the small amplitude of data sheets


class SheetFit(NamedTuple):
    """One number of a sheet, and the model's."""

    what: str
    stated: float | None
    """None: not stated, and follows."""
    model: float
    unit: str


def fits(plant: Plant) -> list[SheetFit]:
    """Return the fits of a plant's motor, and of its valve if that is of a data sheet."""
    found = [*_efficiencies(plant.drive)] if isinstance(plant, MotorPlant) else []
    if not isinstance(plant.valve, DataSheetValve):
        return found
    lands = plant_record(plant)[0].valve
    return [*found, *_flows(plant.valve, lands), *_leakages(plant.valve, lands),
            _pressure_gain(plant.valve, lands), *_responses(plant.spool),
            *_behind_hysteresis(plant.spool, plant.valve)]


def _efficiencies(sheet: Motor) -> Iterator[SheetFit]:
    for k, (drop, speed) in enumerate(zip(sheet.pressure_mpa, sheet.speed_rpm)):
        volumetric, mechanical = sheet.efficiencies(k)
        at = f'at {drop:g} MPa and {speed:g} rpm'
        yield SheetFit(f'volumetric efficiency {at}', sheet.volumetric_percent[k],
                       volumetric / PERCENT, '%')
        yield SheetFit(f'mechanical efficiency {at}', sheet.mechanical_percent[k],
                       mechanical / PERCENT, '%')


def ports(current_ma: float, p_a: float, p_b: float, p_s: float, lands: np.record) -> tuple[
        float, ...]:
    """Return (q_a, q_b, q_p, q_t) of a valve in m3/s at a series current and pressures in Pa."""
    x = min(current_ma * MILLI * lands.k_spool, lands.x_max)
    found: tuple[float, ...] = port_flows(x, p_a, p_b, p_s, 0.0, lands)
    return found


def shut(current_ma: float, p_s: float, lands: np.record) -> tuple[float, float]:
    """Return (p_A, p_B) in Pa of a valve whose ports are both shut."""
    found = []
    for port in (0, 1):
        def fills(p: float) -> bool:
            return ports(current_ma, p, p, p_s, lands)[port] > 0.0
        found.append(_root(fills, p_s))
    return found[0], found[1]


def _root(is_below: Callable[[float], bool], most: float) -> float:
    low, high = 0.0, most
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if is_below(middle):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _flows(sheet: DataSheetValve, lands: np.record) -> Iterator[SheetFit]:
    drop = sheet.rated_drop_mpa * MPA
    full = sheet.flow.currents_ma[-1]
    sides = [('extending', 1, sheet.flow.flows_lpm[-1])]
    if isinstance(sheet.flow, SidesFlow):
        sides.append(('retracting', -1, sheet.flow.retracting_lpm[-1]))
    for name, sign, stated in sides:
        q_a = ports(sign * full, 0.5 * drop, 0.5 * drop, drop, lands)[0]
        what = f'flow {name} at {full:g} mA, {sheet.rated_drop_mpa:g} MPa over both lands'
        yield SheetFit(what, None if sheet.compensated_drop_mpa > 0.0 else stated,
                       sign * q_a / LPM, 'l/min')
    if sheet.compensated_drop_mpa > 0.0:
        supply = 2.0 * drop + sheet.compensated_drop_mpa * MPA
        yield SheetFit('flow behind the compensator', None,
                       ports(full, 0.0, 0.0, supply, lands)[0] / LPM, 'l/min')


def _leakages(sheet: DataSheetValve, lands: np.record) -> Iterator[SheetFit]:
    at, full = sheet.leakage, sheet.flow.currents_ma[-1]

    def total(current_ma: float) -> float:
        supply = at.pressure_mpa * MPA
        p_a, p_b = shut(current_ma, supply, lands)
        x = current_ma * MILLI * lands.k_spool
        return float(port_flows(x, p_a, p_b, supply, 0.0, lands)[2]) / LPM
    for current, stated in zip(at.current_ma, at.total_lpm):
        yield SheetFit(f'leakage at {current:g} mA, {at.pressure_mpa:g} MPa', stated,
                       total(current), 'l/min')
    currents = np.linspace(0.0, full, _FINE)
    totals = [total(float(current)) for current in currents]
    k = int(np.argmax(totals))
    yield SheetFit(f'largest leakage, at {currents[k]:.3g} mA', None, totals[k], 'l/min')


def _pressure_gain(sheet: DataSheetValve, lands: np.record) -> SheetFit:
    own, supply = sheet.pressure_gain, sheet.leakage.pressure_mpa * MPA
    current = own.current_percent * PERCENT * sheet.flow.currents_ma[-1]
    p_a, p_b = shut(current, supply, lands)
    base_a, base_b = shut(0.0, supply, lands)
    share = ((p_a - p_b) - (base_a - base_b)) / supply / PERCENT
    return SheetFit(f'pressure gain: load pressure at {own.current_percent:g} % of the current',
                    own.percent if own.percent > 0.0 else None, share, '%')


def _responses(sheet: object) -> Iterator[SheetFit]:
    if isinstance(sheet, DataSheetSpool):
        own = SecondOrder(sheet.natural_frequency_rad_per_s, sheet.damping_ratio)
        for at in ('minus_90_deg', 'minus_3_db'):
            yield SheetFit(f'spool, {_WORDS[at]}', sheet.frequency_hz if sheet.at == at else None,
                           frequency_of(own, at, 0.0), 'Hz')
    if isinstance(sheet, ResponseSpool):
        own = SecondOrder(sheet.natural_frequency_rad_per_s, sheet.damping_ratio)
        yield SheetFit('spool, damping ratio', None, own.zeta, '1')
        for at in ('minus_90_deg', 'minus_3_db'):
            yield SheetFit(f'spool, {_WORDS[at]} at a small amplitude', getattr(sheet, f'{at}_hz'),
                           frequency_of(own, at, 0.0), 'Hz')
        for at in ('minus_90_deg', 'minus_3_db') if sheet.limit > 0.0 else ():
            stated = getattr(sheet, f'large_{at}_hz')
            yield SheetFit(f'spool, {_WORDS[at]} at {sheet.large_percent:g} %', stated or None,
                           frequency_of(own, at, sheet.limit), 'Hz')


def _behind_hysteresis(sheet: object, valve: Hysteretic) -> Iterator[SheetFit]:
    """Yield -90 degrees of spool and hysteresis together, and what makes it the stated one."""
    if not isinstance(sheet, ResponseSpool) or valve.hysteresis_percent == 0.0:
        return
    passed = passed_of_sine(valve, _SMALL)
    own = SecondOrder(sheet.natural_frequency_rad_per_s, sheet.damping_ratio)
    if -passed.imag * sheet.minus_90_deg_hz >= passed.real * sheet.minus_3_db_hz:
        return

    def is_below(frequency: float) -> bool:
        return (gain_at(own, frequency, 1.0) * passed).real > 0.0
    yield SheetFit(f'spool behind the hysteresis, -90 deg at {_SMALL:g} %', None,
                   _root(is_below, own.w_n), 'Hz')
    yield SheetFit(f'minus_90_deg_hz with which that is {sheet.minus_90_deg_hz:g} Hz', None,
                   leading(sheet.minus_90_deg_hz, sheet.minus_3_db_hz, -passed.imag / passed.real),
                   'Hz')


_WORDS = {'minus_90_deg': '-90 deg', 'minus_3_db': '-3 dB'}


def frequency_of(own: SecondOrder, at: str, limit: float) -> float:
    """Return the frequency (Hz) of a point of a response under a speed limit per amplitude."""
    def is_below(frequency: float) -> bool:
        h = response_at(own, frequency, limit)
        return h.real > 0.0 if at == 'minus_90_deg' else magnitude(h) > _GAIN
    return _root(is_below, own.w_n)     # 2 pi times that of -90 degrees
