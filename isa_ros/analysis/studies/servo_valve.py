"""
A servo valve on its bench: every number of its data sheet, measured back from a run.

`free` moves a piston without a load at the rated drop, `shut` has both ports shut at full
pressure, both over one slow cycle of the whole current. Of two branches of a loop the mean is the
valve without hysteresis. Frequencies are those of the spool behind the measured current, by the
stepped sine of `isa bode`.
"""

from dataclasses import asdict
from typing import Any, NamedTuple

from isa_ros.analysis.response.actuator_trace import RATE_HZ
from isa_ros.analysis.response.rig import Choice, rig
from isa_ros.analysis.response.sweep import excitation, FrequencySweep
from isa_ros.analysis.signals.signals import Signals, signals_of
from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.core.frozen import frozen
from isa_ros.core.units import LPM, MILLI, MPA, PERCENT
from isa_ros.plant.spool import ResponseSpool
from isa_ros.plant.valve_sheets import DataSheetValve
from isa_ros.scripting.run import load
from isa_ros.text.page import Page, png_with_palette
from isa_ros.text.progress import Progress
from isa_ros.text.table import digits, LEFT
from matplotlib.figure import Figure
import numpy as np

NAME, TITLE = 'servo_valve', 'A servo valve, measured back from its data sheet'
RIG, SCENARIO = 'rig_servo_valve', 'servo_valve'
FREE, SHUT = 'free', 'shut'
_PERIOD = 50.0                      # s, of the cycle; the loop is closed after a quarter of it
_LEVELS = np.linspace(-0.9, 0.9, 361)       # of the spool's travel, at which branches are compared
_STRAIGHT = (0.3, 0.85)             # of the travel: part of the flow curve taken for its slope
_MEAN_S = 0.2                       # s: the piston swings on its oil
_MOVED = 2e-4                       # of the travel: the spool has turned
SMALL, LARGE = 0.05, 0.9            # amplitudes of the sines, of the travel
_SWEEPS = {SMALL: FrequencySweep(low=4.0, high=110.0, points=14),
           LARGE: FrequencySweep(low=4.0, high=80.0, points=14)}
_HEAD = """# A servo valve from its data sheet

`config/rig_servo_valve.yaml` has the data sheet of a servo valve like a G761 (38 l/min at 7 MPa,
40 mA, 3 % hysteresis, -90 degrees at 80 Hz) in ten lines, on a bench: one valve without load at
its rated drop, one with both ports shut at 21 MPa, both over one cycle of the whole current in
50 s. Here every number of the sheet is measured back from the recorded signals; the frequencies
are those of the spool behind the coil's current. This page is written by

    ./isa study servo_valve --out docs

`./isa params rig_servo_valve.yaml` shows what is fitted of it. What a measurement has beside
the sheet: a cycle of 50 s widens the loop by the lag of the spool; the ports' oil takes time to
follow around null; hysteresis lags at 5 % of the current, which costs phase; and the limited speed
of the spool is found by harmonic balance. So low a supply of an actuator rated at 21 MPa gives the
warning `supply_low`.

*Null shift*: to the current is added 0.286 % of the rated one for each MPa of the supply above
the reference, 21 MPa, and 0.0526 % for each K of the oil above 40 celsius (V12). At 7 MPa that is
-4 %: without current the spool stands at -20 um, towards retracting; +1.6 mA hold it at null; at
+40 mA it is open to 96 %, so that the flow is about 4 % low, and at -40 mA it is at its stop. The
table counts current from the null. `plant.spool.null_bias.current_ma: 1.6` would trim it for this
supply; a force loop with an integral does so by itself, and a position loop rests beside its
setpoint by the current over its gain."""
_SHAPES = """Left: flow over current, without load at 7 MPa. Right: load pressure with both ports
shut, over 10 % of the current; between both branches it moves nearly from stop to stop."""


class Branch(NamedTuple):
    """One way of the cycle, at `_LEVELS` of the spool."""

    current: np.ndarray     # of the rated one
    other: np.ndarray


@frozen
class SheetNumber:
    """One number of the sheet and of the bench."""

    what: str
    unit: str
    stated: float | None
    measured: float


@frozen
class SheetAndBench:
    """All numbers, and the loops of the figure."""

    numbers: tuple[SheetNumber, ...]
    flow: tuple[np.ndarray, np.ndarray]         # current, mA; flow, l/min
    pressure: tuple[np.ndarray, np.ndarray]     # current, mA; load pressure, MPa


def results(progress: Progress | None = None) -> SheetAndBench:
    """Run the bench, and the sines at two amplitudes."""
    signals = signals_of(load(RIG, SCENARIO).simulate())
    if progress is not None:
        progress(1, 3)
    found = [*_of_cycle(signals)]
    for k, amplitude in enumerate((SMALL, LARGE)):
        found += _of_sines(amplitude)
        if progress is not None:
            progress(k + 2, 3)
    return SheetAndBench(tuple(found), _loop(signals, FREE), _loop(signals, SHUT))


def _of_cycle(signals: Signals) -> list[SheetNumber]:
    sheet = _valve(signals, FREE)
    rated, leak = sheet.flow.currents_ma[-1] * MILLI, sheet.leakage
    down, up = branches(signals, FREE, _flow(signals))
    middle, flow = 0.5 * (down.current + up.current), 0.5 * (down.other + up.other)
    part = (np.abs(_LEVELS) > _STRAIGHT[0]) & (np.abs(_LEVELS) < _STRAIGHT[1])
    free_null = _crossing(middle, flow)
    slope = np.polyfit(np.abs(middle[part] - free_null), np.abs(flow[part]), 1)
    p_down, p_up = branches(signals, SHUT, _load_pressure(signals))
    pressure = 0.5 * (p_down.other + p_up.other)
    null = _crossing(0.5 * (p_down.current + p_up.current), pressure)
    leakage = _values(signals, f'{SHUT}.supply_flow')
    l_down, l_up = branches(signals, SHUT, leakage)
    total = 0.5 * (l_down.other + l_up.other)
    supplies = [signals.run.supply_of(name).pressure_mpa for name in (FREE, SHUT)]
    gain = sheet.pressure_gain
    at = np.array([-1.0, 1.0]) * gain.current_percent * PERCENT
    span = np.diff(np.interp(at, _LEVELS, pressure))[0] / (2.0 * leak.pressure_mpa * MPA)
    return [
        SheetNumber('rated flow, 40 mA and 7 MPa', 'l/min', sheet.flow.flows_lpm[-1],
                    float(np.polyval(slope, 1.0)) / LPM),
        SheetNumber('hysteresis, of the current', '%', sheet.hysteresis_percent,
                    float((up.current - down.current).max()) / PERCENT),
        SheetNumber('threshold: current until the spool turns', '%', sheet.threshold_percent,
                    _reversal(signals, rated) / PERCENT),
        SheetNumber('leakage at null', 'l/min', leak.total_lpm[0],
                    float(np.interp(0.0, _LEVELS, total)) / LPM),
        SheetNumber('leakage at 40 mA', 'l/min', leak.total_lpm[-1],
                    float(leakage[np.argmax(_values(signals, f'{SHUT}.current'))]) / LPM),
        SheetNumber('load pressure at 1 % of the current', '%', gain.percent,
                    float(span) / PERCENT),
        SheetNumber('shift of null with supply pressure', '%/MPa',
                    sheet.null_shift.supply_percent_per_mpa,
                    (null - free_null) / PERCENT / (supplies[0] - supplies[1])),
        SheetNumber('load pressure between both branches, no current', 'MPa', None,
                    float(np.interp(0.0, p_down.current, p_down.other)
                          - np.interp(0.0, p_up.current, p_up.other)) / MPA)]


def branches(signals: Signals, name: str, values: np.ndarray) -> tuple[Branch, Branch]:
    """Return the way down and the way up of ``values`` (n,) and the current, over the spool."""
    valve = _valve(signals, name)
    rated = valve.flow.currents_ma[-1] * MILLI
    t = signals.over_time(f'{name}.spool').t
    spool = _values(signals, f'{name}.spool') / (valve.spool_stop_mm * MILLI)
    current = _values(signals, f'{name}.current') / rated
    found = []
    for begin, sign in ((0.25, -1.0), (0.75, 1.0)):
        part = (t >= begin * _PERIOD) & (t < (begin + 0.5) * _PERIOD)
        order = np.argsort(spool[part], kind='stable')
        at = spool[part][order]
        found.append(Branch(np.interp(_LEVELS, at, current[part][order]),
                            np.interp(_LEVELS, at, values[part][order])))
        assert sign * (current[part][-1] - current[part][0]) > 0.0
    return found[0], found[1]


def _valve(signals: Signals, name: str) -> DataSheetValve:
    valve = signals.run.actuator(name).sheet.plant.valve
    assert isinstance(valve, DataSheetValve)
    return valve


def _values(signals: Signals, name: str) -> np.ndarray:
    values: np.ndarray = signals.over_time(name).values
    return values


def _flow(signals: Signals) -> np.ndarray:
    area = signals.run.actuator(FREE).sheet.plant.drive.areas[0]
    t, position = signals.over_time(f'{FREE}.position')
    step = t[1] - t[0]
    flow: np.ndarray = np.gradient(position, step)
    n = round(_MEAN_S / step)
    flow = area * np.convolve(flow, np.full(n, 1.0 / n), mode='same')
    return flow


def _load_pressure(signals: Signals) -> np.ndarray:
    load: np.ndarray = (
        _values(signals, f'{SHUT}.pressure_a') - _values(signals, f'{SHUT}.pressure_b'))
    return load


def _crossing(x: np.ndarray, y: np.ndarray) -> float:
    """Return x where the rising y is 0."""
    return float(np.interp(0.0, y, x))


def _reversal(signals: Signals, rated: float) -> float:
    """Return by how much the current of `SHUT` has fallen when its spool follows, of the rated."""
    signal = signals.over_time(f'{SHUT}.spool')
    travel = _valve(signals, SHUT).spool_stop_mm * MILLI
    part = (signal.t > 0.25 * _PERIOD) & (signal.t < 0.75 * _PERIOD)
    spool, current = signal.values[part], _values(signals, f'{SHUT}.current')[part]
    k = int(np.argmax(spool < spool.max() - _MOVED * travel))
    return float(current.max() - current[k]) / rated


def _of_sines(amplitude: float) -> list[SheetNumber]:
    """Return -90 degrees and -3 dB of the spool over the current at an amplitude."""
    bench = rig(Choice(name=f'{RIG}.yaml', actuator=SHUT, loop='spool'))
    sheet, sweep = bench.config.sheet.plant, _SWEEPS[amplitude]
    values, _, answer = excitation(sweep, RATE_HZ)
    peak = amplitude * sheet.valve.spool_stop_mm * MILLI
    trace = bench.excite(bench.start(), peak * values)
    found = answer.estimate(trace['spool_reference'], trace['current'], trace['spool'])
    gain, phase = found.gain / found.gain[0], found.phase
    assert isinstance(sheet.spool, ResponseSpool)
    stated = ((sheet.spool.minus_90_deg_hz, sheet.spool.minus_3_db_hz) if amplitude == SMALL else
              (sheet.spool.large_minus_90_deg_hz, sheet.spool.large_minus_3_db_hz))
    log = np.log(found.frequency)
    return [
        SheetNumber(f'-90 deg at {amplitude:.0%}'.replace('%', ' %'), 'Hz', stated[0] or None,
                    float(np.exp(np.interp(90.0, -phase, log)))),
        SheetNumber(f'-3 dB at {amplitude:.0%}'.replace('%', ' %'), 'Hz', stated[1] or None,
                    float(np.exp(np.interp(-np.sqrt(0.5), -gain, log))))]


def _loop(signals: Signals, name: str) -> tuple[np.ndarray, np.ndarray]:
    t = signals.over_time(f'{name}.spool').t
    part = (t >= 0.25 * _PERIOD) & (t <= 1.25 * _PERIOD)
    y = _flow(signals) / LPM if name == FREE else _load_pressure(signals) / MPA
    return _values(signals, f'{name}.current')[part] / MILLI, y[part]


def _numbers(found: SheetAndBench) -> dict[str, Any]:
    """Return them in the units of the table."""
    return {'numbers': [asdict(one) for one in found.numbers]}


def _fill(page: Page, found: SheetAndBench) -> None:
    page.table(_table(found))
    page.paragraph(_SHAPES)
    page.figure(NAME, 'Loops of a servo valve', png_with_palette(_drawn(found)))


def _table(found: SheetAndBench) -> list[tuple[str, ...]]:
    return [('of the data sheet', 'unit', 'stated', 'measured'), *(
        (one.what, one.unit, '-' if one.stated is None else f'{one.stated:g}',
         digits(one.measured, 3)) for one in found.numbers)]


def _drawn(found: SheetAndBench) -> Figure:
    figure = Figure(figsize=(9.2, 3.8), dpi=85, layout='constrained')
    left, right = figure.subplots(1, 2)
    left.plot(*found.flow, linewidth=1.0)
    left.set(xlabel='current, mA', ylabel='flow, l/min')
    near = np.abs(found.pressure[0]) < 4.0
    right.plot(found.pressure[0][near], found.pressure[1][near], '.', markersize=1.5)
    right.set(xlabel='current, mA', ylabel='load pressure, MPa')
    for ax in (left, right):
        ax.grid(visible=True, linewidth=0.4)
    return figure


STUDY = OwnStudy(NAME, TITLE, results, _table, _numbers, _HEAD, _fill, LEFT)
