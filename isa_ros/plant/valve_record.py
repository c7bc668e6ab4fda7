"""
From the sheet of a servo valve to the SI record of its metering.

The printed valve gains (eq 19) are slopes of figure 5 in l/min per mA, here per metre of
spool (`flow_slope`).
"""

import math
from typing import NamedTuple

from isa_ros.core.piecewise import LINES, lines_record, y_on_lines
from isa_ros.core.record import record
from isa_ros.core.units import LPM, MICRO, MILLI, MPA, PERCENT
from isa_ros.plant.pressure_gain import land_leakage_at
from isa_ros.plant.stated_curves import SidesFlow
from isa_ros.plant.valve_sheets import DataSheetValve, DualGainValve, HighResponseValve
import numpy as np

VALVE = np.dtype([
    ('k_spool', 'f8'),      # m/A, series scale
    ('k_low', 'f8'), ('k_high', 'f8'),          # m3/s per m of spool at dp_ref
    ('q_rest', 'f8'),                           # m3/s; 0: straight with k_high beyond x_dg
    ('x_dg', 'f8'), ('x_max', 'f8'),            # m
    ('per_root_drop', 'f8'),                    # 1/sqrt(dp_ref), 1/sqrt(Pa)
    ('q_0', 'f8'), ('x_l', 'f8'),               # m3/s, m
    ('c_tare', 'f8'),                           # m3/s/sqrt(Pa)
    ('delta', 'f8'),                            # Pa
    ('f_pa', 'f8'), ('f_at', 'f8'), ('f_bt', 'f8'), ('f_pb', 'f8'),  # land factors
    ('is_lapped', 'f8'),
    ('lap_pa', 'f8'), ('lap_at', 'f8'), ('lap_bt', 'f8'), ('lap_pb', 'f8'),  # m
    ('has_points', 'f8'),   # 1: flow and leakage are the two curves below
    ('flow', LINES), ('leak', LINES),           # m3/s at dp_ref over m of spool
    ('leak_factor', 'f8'),  # of the curve above  (T3)
    ('has_sides', 'f8'),    # 1: retracting, the flow is the curve below
    ('back', LINES),
    ('most_drop', 'f8'),    # over a land from the supply, of a compensator, Pa; 0: none
])


def flow_slope(gain_lpm_per_ma: float, spool_gain_mm_per_ma: float) -> float:
    """Return the slope of one land's flow curve g, in m3/s per m of spool  (V4)."""
    return (gain_lpm_per_ma * LPM) / (spool_gain_mm_per_ma * MILLI)


def land_factors(area_ratio: float) -> tuple[float, float, float, float]:
    """
    Return the factors of the lands P-A, A-T, B-T, P-B for rho = A_A/A_B  (V8).

    1, sqrt(rho), 1/rho, 1/sqrt(rho): equal speed both ways and no pressure jump when the
    direction changes, as section 2.3 of the paper requires of its unequal slots.
    """
    return 1.0, math.sqrt(area_ratio), 1.0 / area_ratio, 1.0 / math.sqrt(area_ratio)


class Lands(NamedTuple):
    """Factors of the four lands  (V8)."""

    pa: float
    at: float
    bt: float
    pb: float


class _Metering(NamedTuple):
    """The fields of a `VALVE` that depend on its kind."""

    k_low: float
    k_high: float
    q_rest: float
    x_dg: float
    per_root_drop: float
    q_0: float
    x_l: float
    c_tare: float
    has_points: float
    flow: np.record
    leak: np.record
    has_sides: float
    back: np.record
    most_drop: float


def _drawn(sheet: DualGainValve | HighResponseValve) -> _Metering:
    """Return the metering of a valve whose curves are those of figures 5 and 6."""
    if isinstance(sheet, HighResponseValve):
        k_low, k_high = flow_slope(sheet.gain_lpm_per_ma, sheet.spool_gain_mm_per_ma), 0.0
        q_rest = sheet.remaining_lpm * LPM
        x_dg = sheet.knee_ma * sheet.spool_gain_mm_per_ma * MILLI
    else:
        k_low = flow_slope(sheet.low_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma)
        k_high = flow_slope(sheet.high_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma)
        q_rest, x_dg = 0.0, sheet.dual_gain_point_mm * MILLI
    none = lines_record([0.0], [0.0])
    return _Metering(
        k_low, k_high, q_rest, x_dg, 1.0 / math.sqrt(sheet.land_drop_mpa * MPA),
        sheet.null_leakage_lpm * LPM, sheet.leakage_travel_um * MICRO,
        sheet.tare_leakage_lpm * LPM / math.sqrt(sheet.tare_pressure_mpa * MPA),
        0.0, none, none, 0.0, none, 0.0)


def land_leakage(
        flow: float, total: float, lands: Lands, root_drops: float, most: float = math.inf
        ) -> float:
    """
    Return the leakage l of a land that gives a valve's ``total`` with both ports shut  (V16).

    In m3/s at dp_ref. P-A and A-T are in series, and so are P-B and B-T: with a = f (g + l) of
    the open land, b = f l of the closed one, each pair passes a b/sqrt(a^2 + b^2) times
    ``root_drops``, sqrt((P_S - P_T)/dp_ref); of a compensated valve at most its land from the
    supply with ``most``, the root of the compensator's drop over P_S - P_T. ``flow`` is g; the
    open lands are P-A and B-T.
    """
    pairs = (lands.pa, lands.at, True), (lands.bt, lands.pb, False)

    def passed(leak: float, opened: float) -> float:
        flow = 0.0
        for f, g, is_supplied in pairs:
            a, b = f * opened, g * leak
            flow += min(a * b / math.sqrt(a * a + b * b), most * (a if is_supplied else b))
        return root_drops * flow

    low, high = 0.0, total / passed(1.0, 1.0)  # a land that is not open needs the most
    while low < 0.5 * (low + high) < high:
        middle = 0.5 * (low + high)
        if passed(middle, flow + middle) < total:
            low = middle
        else:
            high = middle
    return high


def _stated(sheet: DataSheetValve, lands: Lands) -> _Metering:
    """Return the metering of a valve with points of its data sheet  (V15, V16, V26, V27)."""
    k_spool, land_drop = sheet.spool_gain_mm_per_ma, 0.5 * sheet.rated_drop_mpa * MPA
    dead = dead_travel(sheet)
    openings = [max(0.0, i * k_spool * MILLI - dead) for i in sheet.flow.currents_ma]
    flow = lines_record(openings, [q * LPM for q in sheet.flow.flows_lpm])
    back = flow
    if isinstance(sheet.flow, SidesFlow):
        back = lines_record(openings, [q * LPM for q in sheet.flow.retracting_lpm])
    at, own = sheet.leakage, sheet.leakage.pressure_mpa * MPA
    most_drop = sheet.compensated_drop_mpa * MPA
    most = math.sqrt(most_drop / own) if most_drop > 0.0 else math.inf
    travels = [i * k_spool * MILLI for i in at.current_ma]
    leaks = [land_leakage(y_on_lines(x, flow), (total - at.tare_lpm) * LPM, lands,
                          math.sqrt(own / land_drop), most)
             for x, total in zip(travels, at.total_lpm)]
    if sheet.pressure_gain.percent > 0.0:
        x = sheet.pressure_gain.current_percent * PERCENT * sheet.spool_stop_mm * MILLI
        travels.insert(1, x)
        leaks.insert(1, land_leakage_at(sheet.pressure_gain, y_on_lines(x, flow)))
    leak = lines_record(travels, leaks)
    last = len(sheet.flow.currents_ma) - 1
    return _Metering(
        k_low=flow.slope[0], k_high=flow.slope[last - 1], q_rest=0.0, x_dg=flow.x[1],
        per_root_drop=1.0 / math.sqrt(land_drop), q_0=leak.y[0], x_l=flow.x[last],
        c_tare=at.tare_lpm * LPM / math.sqrt(own), has_points=1.0, flow=flow, leak=leak,
        has_sides=float(isinstance(sheet.flow, SidesFlow)), back=back, most_drop=most_drop)


def dead_travel(sheet: DualGainValve | HighResponseValve | DataSheetValve) -> float:
    """Return the overlap of every land that makes the stated dead band, m  (V26)."""
    if isinstance(sheet, DataSheetValve):
        return sheet.dead_band_percent * PERCENT * (sheet.spool_stop_mm * MILLI)
    return 0.0


def null_shift(
        sheet: DualGainValve | HighResponseValve | DataSheetValve, rated: float
        ) -> tuple[float, float]:
    """Return the stated shift of null with supply (A/Pa) and temperature (A/K)  (V12)."""
    if not isinstance(sheet, DataSheetValve):
        return 0.0, 0.0
    own = sheet.null_shift
    return (own.supply_percent_per_mpa * PERCENT * rated / MPA,
            own.temperature_percent_per_k * PERCENT * rated)


def valve_record(
        sheet: DualGainValve | HighResponseValve | DataSheetValve,
        area_ratio: float) -> np.record:
    """Return the `VALVE` record of a sheet on an actuator with A_A/A_B = ``area_ratio``."""
    lands = Lands(*land_factors(area_ratio if sheet.slots == 'matched' else 1.0))
    metering = _stated(sheet, lands) if isinstance(sheet, DataSheetValve) else _drawn(sheet)
    dead = dead_travel(sheet)
    laps = {f'lap_{land}': getattr(sheet.lap, f'{land}_um') * MICRO + dead
            for land in Lands._fields}
    return record(
        VALVE, k_spool=sheet.spool_gain_mm_per_ma, **metering._asdict(),
        x_max=sheet.spool_stop_mm * MILLI, delta=sheet.orifice_smoothing_kpa * 1e3,
        f_pa=lands.pa, f_at=lands.at, f_bt=lands.bt, f_pb=lands.pb,
        is_lapped=float(any(laps.values())), leak_factor=1.0, **laps)
