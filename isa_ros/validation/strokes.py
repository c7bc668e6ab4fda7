"""
Force and torque control against a stiff stop, from 2 to 98 % of the stroke.

Steps and frequency responses at 10 % of the rating: with the shipped gains, with the same
gains but unscheduled, and by feedback linearisation. The smart manifold has the gains of
Table 4, the ISA v5 those retuned for the leg.
"""

from dataclasses import replace

from isa_ros.analysis.response.bode import bode
from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.analysis.response.step import step
from isa_ros.analysis.response.sweep import FrequencySweep
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import replaced
from isa_ros.paper.printed import statement
from isa_ros.reu.block import Pid
from isa_ros.reu.schedule import Constant, OilStiffness
from isa_ros.validation.entry import (
    Drawing, Entry, Findings, OWN, PAPER, RETUNED, TABLE_4)
from isa_ros.validation.plots import stacked
import numpy as np

PLACES = (0.02, 0.10, 0.25, 0.50, 0.75, 0.90, 0.98)  # of the stroke
STEP_S = 0.3
SWEEP = FrequencySweep(low=5.0, high=200.0, points=14)
AS_SHIPPED, OTHERWISE, LINEARISED = 'PID as shipped', 'PID otherwise', 'feedback linearisation'
RISE_SPREAD = 20.0   # percent, allowed about the middle of the range
LINEARISED_OVERSHOOT = 10.0     # percent


@frozen
class Subject:
    """One actuator of this study."""

    model: str
    preset: str
    largest_ripple: float   # N | Nm at rest


SUBJECTS = (Subject('isa_v5', RETUNED, 5.0), Subject('smart_manifold', TABLE_4, 0.3))


@frozen
class Sweeps:
    """The measures at each of `PLACES`, shape (n,)."""

    rise: np.ndarray        # ms
    overshoot: np.ndarray   # percent
    ripple: np.ndarray      # N | Nm
    bandwidth: np.ndarray   # Hz

    @property
    def rise_spread(self) -> float:
        """Return the largest deviation of the rise time from the middle of its range, percent."""
        low, high = float(self.rise.min()), float(self.rise.max())
        return 100.0 * (high - low) / (high + low)


def strokes() -> Findings:
    """Measure both actuators over their strokes, and draw them."""
    entries, drawings = [], []
    for subject in SUBJECTS:
        found = {law: _over_stroke(subject, law) for law in (AS_SHIPPED, OTHERWISE, LINEARISED)}
        entries += _entries(subject, found)
        drawings.append(_drawing(subject, found))
    return Findings(tuple(entries), tuple(drawings))


def _bench(subject: Subject, law: str, place: float) -> Rig:
    variants = ('feedback_linearisation',) if law == LINEARISED else ()
    bench = rig(Choice(
        name=subject.model, loop='force', preset=subject.preset, variants=variants))
    config = replace(
        bench.config, initial_position=place * bench.config.sheet.plant.drive.stroke)
    if law == OTHERWISE:
        reu = config.sheet.reu
        assert isinstance(reu.force, Pid)
        scheduled = isinstance(reu.force.gain_schedule, OilStiffness)
        config = replace(config, sheet=replaced(
            config.sheet, 'reu.force.gain_schedule', Constant() if scheduled else OilStiffness()))
    return bench.with_config(config)


def _over_stroke(subject: Subject, law: str) -> Sweeps:
    rows = []
    for place in PLACES:
        bench = _bench(subject, law, place)
        stepped = step(bench, STEP_S).figures
        swept = bode(bench, SWEEP, 'closed').bandwidth
        rows.append((
            np.nan if stepped.rise_time is None else stepped.rise_time * 1e3,
            stepped.overshoot * 100.0, stepped.ripple, np.nan if swept is None else swept))
    return Sweeps(*np.array(rows).T)


def _entries(subject: Subject, found: dict[str, Sweeps]) -> list[Entry]:
    shipped, linear = found[AS_SHIPPED], found[LINEARISED]
    unit = 'Nm' if subject.model == 'smart_manifold' else 'N'
    over = 'a target for 2 to 98 % of the stroke'
    low, high = (statement(f'small_signal_bandwidth_{end}') for end in ('low', 'high'))
    could = 'could improve the performance'

    def target(name: str, where: str, paper: str, ours: float, unit: str, most: float) -> Entry:
        return Entry(
            name=f'{subject.model}_{name}', source=OWN, where=where, paper=paper, ours=ours,
            unit=unit, tolerance=(0.0, most), tolerance_source=over, gains=subject.preset)
    return [
        *(Entry(name=f'{subject.model}_{name}_bandwidth', source=PAPER, where=low.where,
                paper=f'{low.text} to {high.text}', ours=ours, unit='Hz',
                tolerance=(low.number, high.number),
                tolerance_source='the printed range, at every place', gains=subject.preset)
          for name, ours in (('least', float(shipped.bandwidth.min())),
                             ('largest', float(shipped.bandwidth.max())))),
        target('rise_spread', 'section 2.3', 'no scheduling by direction', shipped.rise_spread,
               'percent', RISE_SPREAD),
        target('ripple_at_rest', 'section 5.1', 'hunting was seen', float(shipped.ripple.max()),
               unit, subject.largest_ripple),
        target('linearised_overshoot', 'section 5.2', could, float(linear.overshoot.max()),
               'percent', LINEARISED_OVERSHOOT),
        target('linearised_rise_spread', 'section 5.2', could, linear.rise_spread, 'percent',
               RISE_SPREAD)]


def _drawing(subject: Subject, found: dict[str, Sweeps]) -> Drawing:
    figure, (rise, overshoot, bandwidth, ripple) = stacked(
        'place, % of the stroke', 'rise, ms', 'overshoot, %', '-3 dB, Hz',
        'ripple, Nm' if subject.model == 'smart_manifold' else 'ripple, N')
    shipped_is_scheduled = subject.model == 'isa_v5'
    labels = {AS_SHIPPED: 'PID, scheduled' if shipped_is_scheduled else 'PID, fixed gains',
              OTHERWISE: 'PID, fixed gains' if shipped_is_scheduled else 'PID, scheduled',
              LINEARISED: LINEARISED}
    places = 100.0 * np.array(PLACES)
    for law, style in ((AS_SHIPPED, 'ko-'), (OTHERWISE, 'C0s--'), (LINEARISED, 'C3^-')):
        sweeps = found[law]
        for ax, values in ((rise, sweeps.rise), (overshoot, sweeps.overshoot),
                           (bandwidth, sweeps.bandwidth), (ripple, sweeps.ripple)):
            ax.plot(places, values, style, markersize=4, label=labels[law])
    for ax in (rise, overshoot, bandwidth, ripple):
        ax.set_ylim(bottom=0.0)
    rise.legend(fontsize='small')
    return Drawing(
        f'strokes_{subject.model}', f'{subject.model}, gains {subject.preset}: steps and '
        'responses of 10 % of the rating against a stiff stop.', figure)
