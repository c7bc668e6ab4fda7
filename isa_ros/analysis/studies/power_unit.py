"""
A power unit for the quadruped: pump and accumulator against the sag of its supply in a trot.

The shipped run trots and is pushed, with other pumps and accumulators. The columns come from the
samples of the circuit, whose last ones are its account: flow and energies are their differences,
peaks those of one tick.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from textwrap import fill
from typing import Any, NamedTuple
import warnings

from isa_ros.analysis.studies import warm_up
from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.core.accounts import HELD, LEAKAGE, PUMP, SUPPLY_SHARES, THROTTLING
from isa_ros.core.frozen import frozen
from isa_ros.core.units import LPM, MPA
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
from isa_ros.text.page import Page, png
from isa_ros.text.progress import Progress, told
from isa_ros.text.table import RIGHT
from isa_ros.tick.trips import TripWarning
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

NAME, TITLE = 'power_unit', 'Power unit of the quadruped: pump and accumulator against the sag'
RUN, UNIT, ROBOT = 'quadruped_power_unit', 'unit', 'quadruped'     # run and scenario, their names
MANIFOLDS = ('front', 'hind')
DURATION = 8.0      # s
STOOD = 0.5         # s: it stands until then
STEADY = 3.0        # s, from which on means are taken; of a shorter run all of it
PUSHED = 6.0        # s, of the scenario
FALLEN = 0.45       # m, height of the trunk, which trots at 0.565
SPEED_RPM = 3000.0

_HEAD = """# A power unit for the quadruped

HyQ-REAL trots at 0.5 m/s and is pushed at 6 s by 108 Ns ([quadruped.md](quadruped.md)), here on
`config/quadruped_power_unit.yaml`: a pump with compensator (20.7 MPa), limit of its power and a
lag of 30 ms at 3000 rpm, a check valve, an accumulator (gas at 12 MPa) on a rail in the trunk, a
tube to the manifold of the front and of the hind legs, and a return with a filter. The table
varies displacement, power and gas volume. The values of the file are the row in bold. Written by

    ./isa study power_unit --out docs

Sag is what the rail loses of the pressure at which the robot stands: in the trot up to the push,
and after it. The lowest pressure is that at a manifold, behind the tubes. Means are those from 3 s
to the end, peaks those of a tick. Watts are those of the oil: what the pump gives, without its
efficiency, what check valve, tubes, relief valve and return lose, and what the servo valves lose
by throttling and leakage."""
_CLOSES = 'Each account of a circuit (E12 of [equations.md](equations.md)) closes within {:.0e}.'


class PowerUnit(NamedTuple):
    """A row: what the unit has."""

    displacement: float     # ml
    power: float            # W, its limit
    gas: float              # l

    @property
    def flow(self) -> float:
        """Return the largest flow of its pump, l/min."""
        return 1e-3 * self.displacement * SPEED_RPM

    @property
    def parameters(self) -> dict[str, float]:
        """Return its values by key."""
        parts = f'supplies.{UNIT}.parts'
        return {f'{parts}.pump.displacement_ml': self.displacement,
                f'{parts}.pump.power_w': self.power, f'{parts}.buffer.gas_volume_l': self.gas}


CHOSEN = PowerUnit(5.0, 5000.0, 0.32)
UNITS = (PowerUnit(3.5, 5000.0, 0.16), PowerUnit(3.5, 5000.0, 0.75), PowerUnit(4.0, 5000.0, 0.16),
         PowerUnit(4.0, 5000.0, 0.75), PowerUnit(5.0, 5000.0, 0.02),
         PowerUnit(5.0, 5000.0, 0.16), CHOSEN,
         PowerUnit(7.0, 5000.0, 0.16), PowerUnit(7.0, 4000.0, 0.16))


@frozen
class SuppliedTrot:
    """The trot on one unit; SI, means and peaks as the page has them."""

    unit: PowerUnit
    sag: float          # Pa
    pushed_sag: float   # Pa; NaN: it ended before
    lowest: float       # Pa
    flow: float         # m3/s
    peak_flow: float
    power: float        # W, of the pump
    peak_power: float
    lost: float         # W, in the circuit
    valves: float       # W, in the servo valves
    heat: float         # W, of the oil
    fell: float         # s; NaN: it did not
    gap: float          # of the account, of what the pump gave
    time: NDArray[np.float64]       # s
    pressure: NDArray[np.float64]   # Pa, of the rail
    drawn: NDArray[np.float64]      # m3/s, by tick
    pumped: NDArray[np.float64]


def results(
        progress: Progress | None = None, units: Sequence[PowerUnit] = UNITS,
        duration: float = DURATION) -> list[SuppliedTrot]:
    """Let it trot on each unit."""
    return [supplied(unit, trot(unit, duration)) for unit in told(units, progress)]


def trot(unit: PowerUnit, duration: float) -> Result:
    """Return the run on a unit; one that falls trips, which its row says."""
    run = load(RUN, RUN, changes=unit.parameters)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', TripWarning)
        return run.simulate(duration)


def supplied(unit: PowerUnit, result: Result) -> SuppliedTrot:
    """Return the numbers of a run."""
    time, rail = result.time, result[f'{UNIT}/rail.pressure']
    late = STEADY if time[-1] > STEADY else 0.0
    stood = rail[time <= STOOD][-1]
    before, after = rail[time < PUSHED], rail[time >= PUSHED]
    drawn, pump = (_rate(result, f'{UNIT}.{name}') for name in ('drawn', 'pump_energy'))
    # the heat that the gas takes is no loss, and stands with a minus
    lost = (_rate(result, f'{UNIT}.relief_energy') + _rate(result, f'{UNIT}.return_energy')
            - _rate(result, f'{UNIT}/buffer.relief_energy'))
    valves = np.sum([_rate(result, f'{own.name}.{share.field}') for share in (THROTTLING, LEAKAGE)
                     for own in result.scenario.run.actuators], axis=0)
    steady = time[1:] > late
    power = float(pump[steady].mean())
    low = result[f'{ROBOT}.position'][:, 2] < FALLEN
    return SuppliedTrot(
        unit, float(stood - before.min()), float(stood - after.min()) if len(after) else np.nan,
        min(float(result[f'{UNIT}/{place}.pressure'].min()) for place in MANIFOLDS),
        float(drawn[steady].mean()), float(drawn.max()), power,
        float(pump.max()), float(lost[steady].mean()), float(valves[steady].mean()),
        warm_up.heat_of(result, UNIT, power, late),
        float(time[low.argmax()]) if low.any() else np.nan, gap_of(result.accounts[UNIT]),
        time, rail, drawn, result[f'{UNIT}.pump_flow'])


def _rate(result: Result, integral: str) -> NDArray[np.float64]:
    """Return the means of each tick of what a signal is the integral of, (n,)."""
    rate: NDArray[np.float64] = np.diff(result[integral]) / np.diff(result.time)
    return rate


def gap_of(account: Mapping[str, float]) -> float:
    """Return what the account of a circuit lacks, of what its pump gave  (E12)."""
    given = account[PUMP.key]
    lacks = given + account[HELD.key] - sum(account[share.key] for share in SUPPLY_SHARES)
    return abs(lacks) / given


def _numbers(found: Sequence[SuppliedTrot]) -> dict[str, Any]:
    """Return them without traces; None where there is no number."""
    outcomes = []
    for one in found:
        numbers = {key: value for key, value in asdict(one).items() if np.ndim(value) == 0}
        outcomes.append({key: None if np.isnan(value) else value
                         for key, value in numbers.items()} | {'unit': one.unit._asdict()})
    return {'outcomes': outcomes}


def _fill(page: Page, found: Sequence[SuppliedTrot]) -> None:
    page.table(_table(found, '**'), RIGHT)
    page.paragraph(_CLOSES.format(max(one.gap for one in found)))
    page.figure(NAME, 'Pressure of the rail, and the flows of the chosen unit',
                png(_drawn(found)))
    page.paragraph(_seen({one.unit: one for one in found}))
    chosen = next((one for one in found if one.unit == CHOSEN), None)
    if chosen is not None:
        before, follows = (fill(text, 99) for text in warm_up.seen(chosen.heat))
        page.section('Warm-up')
        page.paragraph(before)
        page.table(warm_up.table(chosen.heat), RIGHT)
        page.paragraph(follows)


def _seen(by_unit: Mapping[PowerUnit, SuppliedTrot]) -> str:
    """Return what follows from the run; nothing of a part of it."""
    if not set(UNITS) <= set(by_unit):
        return ''
    tiny, half, own = (by_unit[CHOSEN._replace(gas=gas)] for gas in (0.02, 0.16, CHOSEN.gas))
    strong, weak = (by_unit[PowerUnit(7.0, power, 0.16)] for power in (5000.0, 4000.0))
    starved, buffered = (by_unit[PowerUnit(3.5, 5000.0, gas)] for gas in (0.16, 0.75))
    low = min(one.lowest for one in by_unit.values() if np.isnan(one.fell))
    return '\n\n'.join(fill(text, 99) for text in (
        f'**The pump must give the mean flow.** The trot takes {own.flow / LPM:.0f} l/min and '
        f'{1e-3 * own.power:.1f} kW. {starved.unit.flow:g} l/min are less: the pressure goes down '
        f'from stride to stride, by {starved.sag / MPA:.1f} MPa until the push, after which the '
        f'robot falls with {starved.unit.gas:g} l. {buffered.unit.gas:g} l put that off.',
        '**The accumulator must give the peaks**: they are up to '
        f'{own.peak_flow / LPM:.0f} l/min, and the pump follows within 30 ms. With a pump of '
        f'{own.unit.flow:g} l/min the sag in the trot is {tiny.sag / MPA:.1f}, '
        f'{half.sag / MPA:.1f} and {own.sag / MPA:.1f} MPa with 0.02, 0.16 and '
        f'{own.unit.gas:g} l. {strong.unit.flow:g} l/min instead hardly help: '
        f'{strong.sag / MPA:.1f} MPa with 0.16 l. The push asks for flow and power: there it is '
        f'{half.pushed_sag / MPA:.1f} MPa with {half.unit.flow:g} l/min, '
        f'{strong.pushed_sag / MPA:.1f} MPa with {strong.unit.flow:g} l/min, and '
        f'{weak.pushed_sag / MPA:.1f} MPa if its limit is 4 kW.',
        f'**The losses are in the servo valves**: {own.valves:.0f} of {own.power:.0f} W, and '
        f'{own.lost:.0f} W in the circuit. Short lows do no harm: a run with {low / MPA:.1f} MPa '
        'at a manifold stayed up. The chosen unit has a quarter more flow than the mean, and '
        f'needs {1e-3 * own.peak_power:.1f} kW at its peak.'))


def _table(found: Sequence[SuppliedTrot], mark: str = '') -> list[tuple[str, ...]]:
    return [('pump', 'limit, kW', 'accumulator, l', 'sag, MPa', 'pushed', 'lowest, MPa',
             'flow, l/min', 'peak', 'pump, W', 'peak', 'lost, W', 'valves, W', 'stays up'),
            *(_row(one, mark) for one in found)]


def _row(one: SuppliedTrot, mark: str) -> tuple[str, ...]:
    unit = one.unit
    pump = f'{unit.displacement:g} ml, {unit.flow:g} l/min'
    return (f'{mark}{pump}{mark}' if unit == CHOSEN else pump,
            f'{1e-3 * unit.power:g}', f'{unit.gas:g}',
            *('-' if np.isnan(value) else f'{value / MPA:.1f}'
              for value in (one.sag, one.pushed_sag, one.lowest)),
            *(f'{value / LPM:.1f}' for value in (one.flow, one.peak_flow)),
            *(f'{value:.0f}' for value in (one.power, one.peak_power, one.lost, one.valves)),
            'yes' if np.isnan(one.fell) else f'falls at {one.fell:.1f} s')


def _drawn(found: Sequence[SuppliedTrot]) -> Figure:
    figure = Figure(figsize=(8.6, 6.0), dpi=85, layout='constrained')
    pressure, flow = figure.subplots(2, 1, sharex=True)
    for one in found:
        pressure.plot(one.time, one.pressure / MPA, linewidth=1.8 if one.unit == CHOSEN else 0.9,
                      label=f'{one.unit.flow:g} l/min, {1e-3 * one.unit.power:g} kW, '
                            f'{one.unit.gas:g} l')
    chosen = next((one for one in found if one.unit == CHOSEN), found[0])
    flow.plot(chosen.time[1:], chosen.drawn / LPM, linewidth=0.8, label='actuators')
    flow.plot(chosen.time, chosen.pumped / LPM, linewidth=1.4, label='pump')
    pressure.set(ylabel='rail, MPa')
    flow.set(xlabel='time, s', ylabel='chosen unit, l/min')
    for ax in (pressure, flow):
        ax.grid(visible=True, linewidth=0.3)
        ax.legend(fontsize='x-small', loc='lower left', ncols=2)
    return figure


STUDY = OwnStudy(NAME, TITLE, results, _table, _numbers, _HEAD, _fill)
