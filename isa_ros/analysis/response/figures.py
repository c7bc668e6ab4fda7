"""Figures of `isa bode` and `isa step`."""

from isa_ros.analysis.response.bode import Bode
from isa_ros.analysis.response.loops import CLOSED, PLANT
from isa_ros.analysis.response.step import Step
from isa_ros.analysis.signals.frequency import HALF_POWER
from matplotlib.figure import Figure
import numpy as np

_ON_OUTPUT = {CLOSED: 'Y/R', PLANT: 'Y/U'}


def bode_figure(measured: Bode, title: str) -> Figure:
    """Draw gain, phase and coherence over frequency."""
    figure = Figure(figsize=(8.0, 7.0), dpi=110, layout='constrained')
    gain, phase, coherence = figure.subplots(
        3, 1, sharex=True, height_ratios=(3.0, 2.0, 1.0))
    figure.suptitle(title, fontsize='medium')
    response, unit = measured.response, measured.loop.response_unit(measured.of)
    decibels = response.gain_db - 20.0 * np.log10(unit.scale)
    gain.semilogx(response.frequency, decibels, marker='.', color='C0')
    of = '' if unit.symbol == '1' else f' of {unit.symbol}'
    gain.set_ylabel(f'gain {_ON_OUTPUT.get(measured.of, "Y/E")}, dB{of}')
    if measured.of == CLOSED:
        gain.axhline(20.0 * np.log10(HALF_POWER), color='gray', linestyle=':', label='-3 dB')
        if measured.bandwidth is not None:
            gain.axvline(measured.bandwidth, color='C3', linestyle='--',
                         label=f'{measured.bandwidth:.3g} Hz')
        gain.legend(loc='lower left', fontsize='small')
    phase.semilogx(response.frequency, response.phase, marker='.', color='C0')
    phase.set_ylabel('phase, deg')
    coherence.semilogx(response.frequency, response.coherence, marker='.', color='C0')
    coherence.set_ylim(0.0, 1.05)
    coherence.set_ylabel('coherence')
    coherence.set_xlabel('frequency, Hz')
    for ax in (gain, phase, coherence):
        ax.grid(visible=True, which='both', linewidth=0.4)
        ax.margins(x=0.0)
    return figure


def step_figure(measured: Step, title: str) -> Figure:
    """Draw reference and output, and the output of the loop's block, over time."""
    loop, has_inward = measured.loop, measured.inward is not None
    figure = Figure(figsize=(8.0, 6.0 if has_inward else 4.0), dpi=110, layout='constrained')
    axes = figure.subplots(
        2 if has_inward else 1, 1, sharex=True, squeeze=False,
        height_ratios=(2.0, 1.0) if has_inward else None).ravel()
    figure.suptitle(title, fontsize='medium')
    t = measured.t * 1e3
    axes[0].plot(t, measured.reference / loop.unit.scale, color='C1', linestyle='--',
                 linewidth=1.0, label='reference')
    axes[0].plot(t, measured.output / loop.unit.scale, color='C0', linewidth=1.2, label='output')
    axes[0].set_ylabel(f'{loop.label}, {loop.unit.symbol}')
    axes[0].legend(loc='lower right', fontsize='small')
    if measured.inward is not None:
        axes[1].plot(t, measured.inward / loop.inward_unit.scale, color='C2', linewidth=1.0)
        name = str(loop.inward).replace('_', ' ')
        axes[1].set_ylabel(f'{name}, {loop.inward_unit.symbol}')
    for ax in axes:
        ax.grid(visible=True, linewidth=0.4)
        ax.margins(x=0.0)
    axes[-1].set_xlabel('time from the step, ms')
    return figure
