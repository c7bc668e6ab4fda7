"""
What hysteresis does to a force loop at null: the limit cycle against the gains.

The output is blocked, the loop is pushed to 10 % of its rating and back to 0, and what is left
0.8 s later is its limit cycle, peak to peak. Both gains K_p and K_i are multiplied.
"""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from isa_ros.analysis.response.actuator_trace import RATE_HZ
from isa_ros.analysis.response.rig import BLOCKED, Choice, Rig, rig
from isa_ros.analysis.signals.frequency import ripple, ripple_frequency
from isa_ros.analysis.studies.measure import changed, RIPPLE_S, up_and_back
from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.core.frozen import frozen
from isa_ros.reu.block import Pid
from isa_ros.text.page import Page, png_with_palette
from isa_ros.text.progress import Progress, told
from isa_ros.text.table import digits, RIGHT
from matplotlib.figure import Figure

NAME, TITLE = 'hysteresis', 'Hysteresis of the valve: limit cycle of a force loop at null'
MODEL, PRESET = 'isa_v5', 'default'
DITHER_HZ = 250.0
GAINS = (0.25, 0.5, 1.0, 2.0)       # of those of the preset
CODES = 1.5     # of the force sensor, peak to peak: more is a limit cycle
_HEAD = """# What hysteresis does to a force loop

An ISA v5 with its output blocked and the gains of its preset times 0.25 to 2, pushed to 10 % of
its rating and back to 0 N, where its valve is at null. The table has what is left 0.8 s later, in
N peak to peak, and its frequency; `-` is at most 1.5 codes of the force sensor. The valve has
the hysteresis and threshold of the row, in percent of its rated current, and in the last rows a
dither of the REU's current block, 250 Hz. This page is written by

    ./isa study hysteresis --out docs
"""
_SEEN = """With an integral in the loop a play makes it hunt, more and slower the lower the gains
are: the integral must cross the play before anything moves. The threshold decides it; the rest of
the hysteresis is no dead zone, and costs gain and phase only. A dither beyond half of the
threshold ends the hunting; it is a ripple of its own."""


class ValveCase(NamedTuple):
    """A row: what the valve has, and what the REU does about it, in percent."""

    hysteresis: float
    threshold: float
    dither: float = 0.0

    @property
    def label(self) -> str:
        """Return it in words."""
        words = 'none' if not self.hysteresis else f'{self.hysteresis:g} / {self.threshold:g} %'
        return f'{words}, dither {self.dither:g} %' if self.dither else words

    @property
    def parameters(self) -> dict[str, float]:
        """Return the values by key."""
        return {'plant.valve.hysteresis_percent': self.hysteresis,
                'plant.valve.threshold_percent': self.threshold,
                'reu.current.dither_hz': DITHER_HZ, 'reu.current.dither_percent': self.dither}


VALVES = (ValveCase(0.0, 0.0), ValveCase(0.5, 0.5), ValveCase(1.0, 1.0), ValveCase(3.0, 0.5),
          ValveCase(3.0, 1.0), ValveCase(3.0, 3.0), ValveCase(3.0, 1.0, 1.0),
          ValveCase(3.0, 3.0, 2.0))


@frozen
class Hunting:
    """A valve at one gain."""

    valve: ValveCase
    gain: float
    ripple: float               # N, peak to peak
    frequency: float | None     # Hz; None: no limit cycle


def results(
        progress: Progress | None = None, valves: Sequence[ValveCase] = VALVES,
        gains: Sequence[float] = GAINS) -> list[Hunting]:
    """Measure each valve at each gain."""
    bench = rig(Choice(name=MODEL, loop='force', preset=PRESET, load=BLOCKED))
    cases = [(valve, gain) for valve in valves for gain in gains]
    return [hunting(bench, *case) for case in told(cases, progress)]


def hunting(bench: Rig, valve: ValveCase, gain: float) -> Hunting:
    """Return what is left of a push."""
    sheet = bench.config.sheet
    step = 2.0 * sheet.plant.sensors.force_range / 2.0 ** sheet.plant.sensors.adc_bits
    force = sheet.reu.force
    assert isinstance(force, Pid)
    own = changed(bench, 'force', valve.parameters | {
        'reu.force.kp': gain * force.kp, 'reu.force.ki': gain * force.ki})
    last = up_and_back(own)[1][-round(RIPPLE_S * RATE_HZ):]
    size = 2.0 * ripple(last)
    return Hunting(valve, gain, size,
                   ripple_frequency(last, RATE_HZ) if size > CODES * step else None)


def _numbers(found: Sequence[Hunting]) -> dict[str, Any]:
    return {'model': MODEL, 'preset': PRESET,
            'outcomes': [asdict(one) | {'valve': one.valve._asdict()} for one in found]}


def _fill(page: Page, found: Sequence[Hunting]) -> None:
    page.table(_table(found), RIGHT)
    page.paragraph(_SEEN)
    page.figure(NAME, TITLE, png_with_palette(_drawn(found)))


def _rows(found: Sequence[Hunting]) -> dict[ValveCase, list[Hunting]]:
    rows: dict[ValveCase, list[Hunting]] = {}
    for one in found:
        rows.setdefault(one.valve, []).append(one)
    return rows


def _table(found: Sequence[Hunting]) -> list[tuple[str, ...]]:
    rows = _rows(found)
    gains = [one.gain for one in next(iter(rows.values()))]
    return [('hysteresis / threshold', *(f'gains x {gain:g}' for gain in gains)), *(
        (valve.label, *(_cell(one) for one in row)) for valve, row in rows.items())]


def _cell(one: Hunting) -> str:
    if one.frequency is None:
        return '-'
    return f'{digits(one.ripple, 2)} N, {digits(one.frequency, 2)} Hz'


def _drawn(found: Sequence[Hunting]) -> Figure:
    figure = Figure(figsize=(7.2, 4.2), dpi=85, layout='constrained')
    ax = figure.subplots()
    for valve, row in _rows(found).items():
        ax.loglog([one.gain for one in row], [max(one.ripple, 1.0) for one in row],
                  '--' if valve.dither else 'o-', markersize=4, label=valve.label)
    ax.set(xlabel='gains, of those of the preset', ylabel='left at null, N peak to peak')
    ax.grid(visible=True, which='both', linewidth=0.3)
    ax.legend(fontsize='x-small')
    return figure


STUDY = OwnStudy(NAME, TITLE, results, _table, _numbers, _HEAD, _fill)
