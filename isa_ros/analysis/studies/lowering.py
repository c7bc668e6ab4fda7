"""
A boom that is let down behind a counterbalance valve: by its position, and by its force.

The crane of `config/crane_counterbalance.yaml` follows `config/scenarios/lower_boom.yaml`; pilot
ratio and opening of its valve are varied, and the loop of the lift cylinder. The study is shown
as text, as JSON, and as the page docs/lowering.md.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple
import warnings

from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI, MPA
from isa_ros.reu.block import Pid
from isa_ros.scripting.run import load
from isa_ros.text.page import Page, png_with_palette
from isa_ros.text.progress import Progress, told
from isa_ros.text.table import digits, RIGHT
from isa_ros.tick.trips import TripWarning
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

NAME, TITLE = 'lowering', 'A boom let down behind a counterbalance valve'
RUN, SCENARIO, BOOM = 'crane_counterbalance', 'lower_boom', 'crane/lift'
DOWN = (4.5, 9.5)       # s: while it is let down
SLOWEST = 2.0           # Hz: above the load's pendulum, which swings anyway
WEIGHT = 36500.0        # N, at the lift cylinder
BY_POSITION, BY_FORCE, SOFT = 'position', 'force', 'force, soft, without the weight'

_LIFT = 'robots.crane.actuators.lift'
_STIFF = {'stiffness': 2e6, 'damping': 6e4}
_HEAD = """# A boom let down behind a counterbalance valve

The crane of `config/crane_counterbalance.yaml` lifts its boom by 80 mm of the lift cylinder and
lets it down by 160 mm, at up to 40 mm/s. Its load of 36 kN is 5.7 MPa in chamber A, the valve is
set to 7.8 MPa ([parts.md](parts.md)). Ratio and opening of the valve are varied, and the loop
that moves the cylinder: the position alone, or an impedance of 2 MN/m with a loop of the force
and the weight fed forward, its K_p in parts of the model's. This page is written by

    ./isa study lowering --out docs

`./isa bringup crane_counterbalance lower_boom` is one such run, by the position at a ratio of 1.5.
"""
_TEXT = """A counterbalance valve is opened by the pressure of the other side, which falls as the
boom sinks: the loop through valve, boom and oil is damped the less the larger the pilot ratio is.
With the position's loop the pressure swings at 3 Hz, the boom on its oil, the more the larger the
ratio: choose 1 to 1.5 where a load swings. That costs pilot pressure, {pilot_least:.1f} MPa
instead of {pilot_most:.1f}. An opening of 1 instead of 4 MPa hardly matters here, for the line's
back pressure through the valve's own land counts 1 + R times (V43). A vented spring chamber
takes that away: behind a servo valve, which at null has half of the supply pressure in both
lines, such a valve is open and holds nothing.

**A loop of the force hunts** at some 30 Hz with the model's gains from a ratio of 3 on: the lag
of the poppet comes into the loop while the boom sinks. A ratio of 1, an opening of 12 MPa, a
poppet of 2 ms or half of the proportional gain each end it; a smaller integral gain does not.

**A soft impedance trips.** If it does not know the weight its reference begins at 0 N, as if the
boom were to sink until the spring bears it. The valve holds the boom, the load cell keeps
reading the weight, and the protection sees a force that does not follow (`force_error`). Feed
the weight forward (`effort`), or move a boom with such valves by its position, as cranes do.

On the circuit of `config/crane_circuit.yaml` the same boom follows as well. Neglected are the
volume of the pilot line and what throttles it, the usual remedy for a ratio that is too large."""


class LoweringCase(NamedTuple):
    """One valve and loop."""

    loop: str
    ratio: float
    opening_mpa: float = 4.0
    lag_ms: float = 10.0
    """Of the poppet."""
    gain: float = 1.0
    """Of the force loop, over the model's K_p."""


CASES = (*(LoweringCase(BY_POSITION, ratio) for ratio in (1.0, 1.5, 3.0, 5.0, 10.0)),
         LoweringCase(BY_POSITION, 10.0, opening_mpa=1.0),
         *(LoweringCase(BY_FORCE, ratio) for ratio in (1.0, 1.5, 3.0, 10.0)),
         LoweringCase(BY_FORCE, 3.0, opening_mpa=12.0), LoweringCase(BY_FORCE, 3.0, lag_ms=2.0),
         LoweringCase(BY_FORCE, 3.0, gain=0.5), LoweringCase(SOFT, 1.5))
SHOWN = (LoweringCase(BY_POSITION, 1.5), LoweringCase(BY_POSITION, 10.0),
         LoweringCase(BY_FORCE, 3.0))
"""Those of the figure."""


@frozen
class Lowering:
    """What one case does, SI, (n,)."""

    case: LoweringCase
    time: NDArray[np.float64]
    position: NDArray[np.float64]
    reference: NDArray[np.float64]
    pressure: NDArray[np.float64]
    """Of chamber A."""
    pilot: NDArray[np.float64]
    """Of chamber B."""
    trips: tuple[str, ...]

    @property
    def _down(self) -> NDArray[np.bool_]:
        return (self.time >= DOWN[0]) & (self.time < DOWN[1])

    @property
    def error(self) -> float:
        """Return its largest distance from the setpoint while it is let down, m."""
        return float(np.abs(self.position - self.reference)[self._down].max())

    @property
    def fastest(self) -> float:
        """Return its largest speed inwards, m/s."""
        return float(-np.diff(self.position)[self._down[1:]].min() / self.time[1])

    @property
    def largest_pilot(self) -> float:
        """Return the largest pressure of chamber B while it is let down, Pa."""
        return float(self.pilot[self._down].max())

    @property
    def swing(self) -> tuple[float, float]:
        """Return rms, Pa, and frequency, Hz, of chamber A's pressure above `SLOWEST`."""
        down = self.pressure[self._down]
        line = np.linspace(0.0, 1.0, len(down))
        rest = down - np.polyval(np.polyfit(line, down, 3), line)
        lines = np.fft.rfft(rest * np.hanning(len(rest)))
        frequency = np.fft.rfftfreq(len(rest), self.time[1])
        power = np.where(frequency >= SLOWEST, np.abs(lines) * np.abs(lines), 0.0)
        # a Hann window keeps 3/8 of the power; each line stands for two
        mean = 2.0 * power.sum() / (0.375 * len(rest) * len(rest))
        return float(np.sqrt(mean)), float(frequency[power.argmax()])


def _own_gain() -> float:
    """Return the force loop's K_p that the model gives this cylinder, A per N."""
    run = load('crane').configuration
    loop = run.actuators[run.index('lift')].sheet.reu.force
    assert isinstance(loop, Pid)
    return loop.kp


def _changes(case: LoweringCase) -> dict[str, Any]:
    holding = f'{_LIFT}.parameters.plant.holding_a'
    changes: dict[str, Any] = {
        f'{holding}.pilot_ratio': case.ratio, f'{holding}.opening_mpa': case.opening_mpa,
        f'{holding}.lag_ms': case.lag_ms}
    if case.loop != BY_POSITION:
        loops = {} if case.gain == 1.0 else {'force': {'kp': case.gain * _own_gain()}}
        changes |= {f'{_LIFT}.variants': [], f'{_LIFT}.parameters.reu': loops}
    return changes


def _scenario(case: LoweringCase) -> str | Tree:
    if case.loop == BY_POSITION:
        return SCENARIO
    # as in the file, with what an impedance needs
    own = {'effort': WEIGHT} if case.loop == BY_FORCE else {}
    gains = _STIFF if case.loop == BY_FORCE else {}
    motion = {'sine': {'amplitude': 0.08, 'frequency_hz': 0.08}}
    return {'name': NAME, 'duration_s': 11.0, 'tracks': {
        BOOM: [{'t_s': 0.0, 'position': 'hold', **own, **gains},
               {'t_s': 0.5, 'position': 'hold', **own, **motion},
               {'t_s': 9.875, 'position': 0.28013, **own}],
        'crane/tilt': [{'t_s': 0.0, 'position': 'hold'}]}}


def outcome(case: LoweringCase) -> Lowering:
    """Simulate one case."""
    with warnings.catch_warnings():     # a case shows a trip
        warnings.simplefilter('ignore', TripWarning)
        result = load(RUN, _scenario(case), changes=_changes(case)).simulate()
    position, reference, pressure, pilot = (
        np.asarray(result[f'{BOOM}.{name}'], float) for name in (
            'position', 'position_reference', 'chamber_pressure_a', 'chamber_pressure_b'))
    return Lowering(case, result.time, position, reference, pressure, pilot, tuple(
        f'{trip.condition}, {digits(trip.t_s, 2)} s' for trip in result.trips))


def results(progress: Progress | None = None) -> list[Lowering]:
    """Simulate all cases."""
    return [outcome(case) for case in told(CASES, progress)]


_COLUMNS: tuple[str, ...] = (
    'loop', 'pilot ratio', 'opening, MPa', 'lag, ms', 'K_p', 'error, mm', 'fastest, mm/s',
    'swing of A, MPa rms', 'at, Hz', 'B up to, MPa', 'trips')


def _table(found: Sequence[Lowering]) -> list[tuple[str, ...]]:
    rows = [_COLUMNS]
    for own in found:
        case, (rms, frequency) = own.case, own.swing
        measured: tuple[str, ...] = ('',) * 5 if own.trips else (
            digits(own.error / MILLI, 2), digits(own.fastest / MILLI, 2), digits(rms / MPA, 2),
            digits(frequency, 2), digits(own.largest_pilot / MPA, 2))
        rows.append((case.loop, f'{case.ratio:g}', f'{case.opening_mpa:g}',
                     f'{case.lag_ms:g}', f'{case.gain:g}' if case.loop == BY_FORCE else '-',
                     *measured, ', '.join(own.trips) or '-'))
    return rows


def _numbers(found: Sequence[Lowering]) -> dict[str, Any]:
    return {'outcomes': [
        {'loop': own.case.loop, 'pilot_ratio': own.case.ratio,
         'opening': own.case.opening_mpa * MPA, 'lag': own.case.lag_ms * MILLI,
         'gain': own.case.gain, 'error': own.error, 'fastest': own.fastest,
         'swing': own.swing[0], 'swing_frequency': own.swing[1],
         'largest_pilot': own.largest_pilot, 'trips': list(own.trips)} for own in found]}


def _fill(page: Page, found: Sequence[Lowering]) -> None:
    by_case: Mapping[LoweringCase, Lowering] = {own.case: own for own in found}
    page.figure(NAME, TITLE, png_with_palette(_figure([by_case[case] for case in SHOWN])))
    page.table(_table(found), RIGHT)
    page.paragraph(_TEXT.format(
        pilot_least=by_case[LoweringCase(BY_POSITION, 1.0)].largest_pilot / MPA,
        pilot_most=by_case[LoweringCase(BY_POSITION, 10.0)].largest_pilot / MPA))


def _figure(found: Sequence[Lowering]) -> Figure:
    figure = Figure(figsize=(7.0, 6.5), dpi=85, layout='constrained')
    axes = figure.subplots(3, 1, sharex=True)
    for own in found:
        label = f'{own.case.loop}, ratio {own.case.ratio:g}'
        axes[0].plot(own.time, own.position / MILLI, label=label)
        axes[1].plot(own.time, (own.position - own.reference) / MILLI)
        axes[2].plot(own.time, own.pressure / MPA, linewidth=0.8)
    axes[0].legend(fontsize='small')
    for ax, text in zip(axes, ('lift cylinder, mm', 'error, mm', 'chamber A, MPa')):
        ax.set_ylabel(text, fontsize='small')
        ax.grid(visible=True, linewidth=0.4)
        ax.tick_params(labelsize='small')
    axes[1].set_ylim(-10.0, 6.0)
    axes[2].set_xlabel('time, s', fontsize='small')
    return figure


STUDY = OwnStudy(NAME, TITLE, results, _table, _numbers, _HEAD, _fill)
