"""Figures of `isa bode` and `isa step`: one response, or several over each other."""

from collections.abc import Sequence

from isa_ros.analysis.response.bode import Bode
from isa_ros.analysis.response.loops import CLOSED, PLANT
from isa_ros.analysis.response.step import StepResponse
from isa_ros.analysis.signals.frequency import HALF_POWER
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_ON_OUTPUT = {CLOSED: 'Y/R', PLANT: 'Y/U'}
_HUNTING = {'linestyle': ':', 'alpha': 0.6}     # the style of a response of a loop that hunts
_WARNING = 'C3'


def bode_figure(responses: Sequence[Bode], labels: Sequence[str], title: str) -> Figure:
    """Draw gain, phase and coherence over frequency, a color for each of the responses."""
    figure = Figure(figsize=(8.0, 7.0), dpi=110, layout='constrained')
    axes = gain, phase, coherence = figure.subplots(
        3, 1, sharex=True, height_ratios=(3.0, 2.0, 1.0))
    figure.suptitle(title, fontsize='medium')
    for k, (measured, label) in enumerate(zip(responses, labels, strict=True)):
        _draw_response(measured, label, f'C{k}', axes)
    first = responses[0]
    symbol = first.loop.response_unit(first.of).symbol
    gain.set_ylabel(f'gain {_ON_OUTPUT.get(first.of, "Y/E")}, dB'
                    f'{"" if symbol == "1" else f" of {symbol}"}')
    if first.of == CLOSED:
        gain.axhline(20.0 * np.log10(HALF_POWER), color='gray', linestyle=':', label='-3 dB')
    if gain.get_legend_handles_labels()[1]:
        gain.legend(loc='lower left', fontsize='small')
    gain.set_title(_hunting(responses, labels), color=_WARNING, fontsize='medium')
    phase.set_ylabel('phase, deg')
    coherence.set_ylim(0.0, 1.05)
    coherence.set_ylabel('coherence')
    coherence.set_xlabel('frequency, Hz')
    for ax in axes:
        ax.grid(visible=True, which='both', linewidth=0.4)
        ax.margins(x=0.0)
    return figure


def _draw_response(measured: Bode, label: str, color: str, axes: Sequence[Axes]) -> None:
    """Draw one response; points that are not trusted are hollow."""
    response, scale = measured.response, measured.loop.response_unit(measured.of).scale
    columns = (response.gain_db - 20.0 * np.log10(scale), response.phase, response.coherence)
    style = _HUNTING if measured.rest.hunts else {}
    doubtful = ~response.is_trusted
    for ax, values in zip(axes, columns, strict=True):
        ax.semilogx(response.frequency, values, marker='.', color=color,
                    label=label if ax is axes[0] and label else None, **style)
        ax.semilogx(response.frequency[doubtful], values[doubtful], linestyle='', marker='o',
                    markerfacecolor='white', color=color)
    if measured.of == CLOSED and measured.bandwidth is not None and not measured.rest.hunts:
        axes[0].axvline(measured.bandwidth, color=color if label else _WARNING, linestyle='--',
                        linewidth=1.0, label=f'{measured.bandwidth:.3g} Hz')


def _hunting(responses: Sequence[Bode], labels: Sequence[str]) -> str:
    """Return which of the loops hunt, a line each."""
    lines = []
    for measured, label in zip(responses, labels, strict=True):
        rest, unit = measured.rest, measured.loop.unit
        if rest.hunts:
            lines.append(
                f'{label or "the loop"} hunts: {rest.ripple / unit.scale:.3g} {unit.symbol} at '
                f'{rest.frequency:.3g} Hz without excitation')
    return '\n'.join(lines)


def step_figure(responses: Sequence[StepResponse], labels: Sequence[str], title: str) -> Figure:
    """
    Draw reference and output, and the output of the loop's block, over time.

    Steps that differ in unit, start or amplitude are drawn as shares of the step.
    """
    first = responses[0]
    in_unit = len({(m.loop.unit, float(m.reference[0]), m.amplitude) for m in responses}) == 1
    has_inward = (first.inward is not None
                  and len({(m.loop.inward, m.loop.inward_unit) for m in responses}) == 1)
    figure = Figure(figsize=(8.0, 6.0 if has_inward else 4.0), dpi=110, layout='constrained')
    axes = figure.subplots(
        2 if has_inward else 1, 1, sharex=True, squeeze=False,
        height_ratios=(2.0, 1.0) if has_inward else None).ravel()
    figure.suptitle(title, fontsize='medium')
    axes[0].plot(first.t * 1e3, _shown(first, first.reference, in_unit), color='gray',
                 linestyle='--', linewidth=1.0, label='reference')
    for k, (measured, label) in enumerate(zip(responses, labels, strict=True)):
        axes[0].plot(measured.t * 1e3, _shown(measured, measured.output, in_unit),
                     color=f'C{k}', linewidth=1.2, label=label or 'output')
        if has_inward and measured.inward is not None:
            axes[1].plot(measured.t * 1e3, measured.inward / measured.loop.inward_unit.scale,
                         color=f'C{k}', linewidth=1.0)
    axes[0].set_ylabel(f'{first.loop.label}, {first.loop.unit.symbol}' if in_unit
                       else f'{first.loop.name}, % of the step')
    axes[0].legend(loc='lower right', fontsize='small')
    if has_inward:
        name = str(first.loop.inward).replace('_', ' ')
        axes[1].set_ylabel(f'{name}, {first.loop.inward_unit.symbol}')
    for ax in axes:
        ax.grid(visible=True, linewidth=0.4)
        ax.margins(x=0.0)
    axes[-1].set_xlabel('time from the step, ms')
    return figure


def _shown(measured: StepResponse, values: np.ndarray, in_unit: bool) -> np.ndarray:
    """Return values in the loop's unit, or in percent of the step from where it began."""
    start, unit = (0.0, measured.loop.unit.scale) if in_unit else (
        float(measured.reference[0]), 0.01 * measured.amplitude)
    shown: np.ndarray = (values - start) / unit
    return shown
