"""
`isa bode`: the frequency response of one loop, with amplitude and coherence.

Closed loop Y/R, plant Y/U and open loop Y/E are estimated from the same closed-loop run: E is
R - Y, U the output of the loop's block to the next one inwards. The margins are those of Y/E,
that is with unity feedback; damping and velocity terms of the block count as part of the plant.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from isa_ros.analysis.response.actuator_trace import RATE_HZ, Trace
from isa_ros.analysis.response.loops import CLOSED, Loop, OPEN, PLANT, Unit
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.response.sweep import Answer, excitation, Sweep
from isa_ros.analysis.signals.frequency import (
    bandwidth, HALF_POWER, Margins, margins, Response, TRUSTED)
from isa_ros.text.table import aligned, RIGHT
import numpy as np


@dataclass(frozen=True)
class Bode:
    """A measured response, with bandwidth and margins from the same run."""

    loop: Loop
    of: str
    response: Response          # output over input in SI
    first_gain: float           # of the closed loop, at the lowest frequency
    bandwidth: float | None     # of the closed loop, relative to a gain of 1, Hz
    margins: Margins            # of the open loop
    amplitude: float            # of the reference, SI


def bode(rig: Rig, sweep: Sweep, of: str, amplitude: float | None = None) -> Bode:
    """
    Measure one response of a rig's loop; ``amplitude`` in the loop's unit.

    Raises
    ------
    ConfigError
        The band or the amplitude is too large for the loop, or it has no such response.
    SimulationDiverged
        A state is no longer finite.

    """
    loop = rig.loop
    sweep.check(loop.rate_hz, f'the {loop.name} loop takes its reference')
    peak = rig.amplitude(amplitude)
    values, rates, answer = excitation(sweep, RATE_HZ)
    trace = rig.excite(rig.start(), peak * values, peak * rates)
    return evaluate(loop, answer, of, peak, trace)


def evaluate(
        loop: Loop, answer: Answer, of: str, amplitude: float, trace: Trace) -> Bode:
    """Return a loop's response from the trace of one run."""
    reference, y = trace[f'{loop.name}_reference'], trace[loop.name]
    closed, opened, requested = (
        answer.estimate(reference, loop.input_of(which, trace), y)
        for which in (CLOSED, OPEN, of))
    return Bode(
        loop, of, requested, float(closed.gain[0]), bandwidth(closed, dc_gain=1.0),
        margins(opened), amplitude)


_HEAD = ('frequency, Hz', 'gain', 'gain, dB', 'phase, deg', 'coherence', 'in', 'out')


def table(measured: Bode) -> str:
    """Return a response as a table, followed by its bandwidth and margins."""
    loop, response = measured.loop, measured.response
    unit, into = loop.response_unit(measured.of), input_unit(measured)
    head = [*_HEAD[:1], f'gain, {unit.symbol}', *_HEAD[2:5],
            f'in, {into.symbol}', f'out, {loop.unit.symbol}']
    value = response.gain / unit.scale
    columns = zip(
        response.frequency, value, 20.0 * np.log10(value), response.phase, response.coherence,
        response.input_amplitude / into.scale, response.output_amplitude / loop.unit.scale)
    rows = [[f'{f:.4g}', f'{gain:.4g}', f'{db:.2f}', f'{phase:.1f}', f'{coherence:.4f}',
             f'{x:.4g}', f'{y:.4g}'] for f, gain, db, phase, coherence, x, y in columns]
    return '\n'.join([*aligned([head, *rows], RIGHT), *conclusions(measured)])


def conclusions(measured: Bode) -> Sequence[str]:
    """Return bandwidth, margins and a warning if the coherence is low, a line each."""
    found, frequency = measured.margins, measured.response.frequency
    band = (f'{measured.bandwidth:.4g} Hz' if measured.bandwidth is not None
            else f'below {frequency[0]:.4g} Hz' if measured.first_gain < HALF_POWER
            else f'above {frequency[-1]:.4g} Hz')
    gain = ('none in this band' if found.gain_db is None
            else f'{found.gain_db:.1f} dB at {found.gain_frequency:.4g} Hz')
    phase = ('none in this band' if found.phase is None
             else f'{found.phase:.1f} deg at {found.phase_frequency:.4g} Hz')
    lines = [f'closed loop, -3 dB: {band}',
             f'open loop, gain margin: {gain}', f'open loop, phase margin: {phase}']
    least = int(measured.response.coherence.argmin())
    if measured.response.coherence[least] < TRUSTED:
        lines.append(
            f'coherence falls to {measured.response.coherence[least]:.2g} at '
            f'{frequency[least]:.4g} Hz, below {TRUSTED:g}: the loop hunts, or noise covers the '
            'response; do not rely on results from these frequencies')
    return lines


def input_unit(measured: Bode) -> Unit:
    """Return the unit of the response's input."""
    return measured.loop.inward_unit if measured.of == PLANT else measured.loop.unit
