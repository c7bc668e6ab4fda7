"""The figure of a study: one column per actuator, the steps above the measures by value."""

from collections.abc import Sequence

from isa_ros.analysis.response.actuator_trace import RATE_HZ
from isa_ros.analysis.studies.measure import MeasuresAt, SMALL, Studied
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_ROWS = ('of the step', 'overshoot, %', '-3 dB, Hz', 'ripple, {force}', 'error in trot, {force}')
_RIPPLES = (('ripple_mid', 'blocked, mid stroke', 'C0o-'),
            ('ripple_end', 'blocked, near the stop', 'C1s-'),
            ('ripple_wheel', 'standing on the wheel', 'C2^-'))

HEADROOM = 1.15     # above the largest value
ROOM = 50.0         # above the largest ripple, for the legend
FLOOR = 2e-4        # of the step: smaller ripples are drawn there


def study_figure(title: str, results: Sequence[Studied]) -> Figure:
    """Draw the outcomes of a study over its values, equal distances apart."""
    figure = Figure(figsize=(4.6 * len(results), 8.6), dpi=85, layout='constrained')
    figure.suptitle(title, fontsize='medium')
    grid = figure.subplots(
        len(_ROWS), len(results), squeeze=False, height_ratios=(1.7, 1.0, 1.0, 1.2, 1.0))
    for axes, result in zip(grid.T, results):
        _column(list(axes), result)
    return figure


def _column(axes: list[Axes], result: Studied) -> None:
    case, found = result.case, result.outcomes
    axes[0].set_title(f'{case.model}, gains {case.preset}', fontsize='small')
    for ax, label in zip(axes, _ROWS):
        ax.set_ylabel(label.format(force=result.force_unit), fontsize='small')
        ax.tick_params(labelsize='small')
        ax.grid(visible=True, linewidth=0.4)
    _steps(axes[0], result)
    places = np.arange(len(found))
    for ax, name in ((axes[1], 'overshoot'), (axes[2], 'bandwidth'), (axes[4], 'force_error')):
        values = _values(found, name)
        ax.plot(places, values, 'C0o-', markersize=4)
        largest = np.nanmax(values, initial=0.0)
        if largest > 0.0:
            ax.set_ylim(0.0, HEADROOM * largest)
    _ripples(axes[3], places, result)
    for ax in axes[1:]:
        ax.set_xlim(-0.3, len(found) - 0.7)
        ax.set_xticks(places, [''] * len(found))
        for k in places[[result.is_shipped(outcome) for outcome in found]]:
            ax.axvline(k, color='gray', linestyle=':')
    axes[-1].set_xticks(places, [f'{outcome.value:g}' for outcome in found])
    axes[-1].set_xlabel(f'{case.unit.symbol}; dotted: as shipped', fontsize='small')


def _steps(ax: Axes, result: Studied) -> None:
    colors = colormaps['viridis'](np.linspace(0.0, 0.9, len(result.outcomes)))
    for outcome, color in zip(result.outcomes, colors):
        t = 1e3 / RATE_HZ * np.arange(len(outcome.step))
        ax.plot(t, outcome.step, color=color, linewidth=2.0 if result.is_shipped(outcome) else 0.8,
                label=f'{outcome.value:g}')
    ax.axhline(1.0, color='gray', linewidth=0.6)
    ax.margins(x=0.0)
    ax.set_xlabel('time from the step at mid stroke, ms', fontsize='x-small')
    ax.legend(fontsize='xx-small', ncols=2, loc='lower right', title=result.case.unit.symbol,
              title_fontsize='xx-small')


def _ripples(ax: Axes, places: np.ndarray, result: Studied) -> None:
    floor = FLOOR * result.amplitude
    largest = SMALL * result.amplitude
    for name, label, style in _RIPPLES:
        values = np.maximum(_values(result.outcomes, name), floor)
        largest = max(largest, float(values.max()))
        ax.semilogy(places, values, style, markersize=4, label=label)
    ax.axhline(SMALL * result.amplitude, color='gray', linestyle='--', linewidth=0.8,
               label=f'{100.0 * SMALL:g} % of the step')
    ax.set_ylim(0.5 * floor, ROOM * largest)
    ax.legend(fontsize='xx-small', ncols=2, loc='upper right')


def _values(found: Sequence[MeasuresAt], name: str) -> np.ndarray:
    """Return one number of every outcome; NaN, which is not drawn, for none."""
    return np.array([getattr(outcome, name) for outcome in found], dtype=float)
