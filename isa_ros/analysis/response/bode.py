"""
`isa bode`: the frequency response of one loop, with amplitude and coherence.

Closed loop Y/R, plant Y/U and open loop Y/E are estimated from the same closed-loop run: E is
R - Y, U the output of the loop's block to the next one inwards. The margins are those of Y/E,
that is with unity feedback; damping and velocity terms of the block count as part of the plant.

After the excitation the reference stands still. A loop that then hunts has a limit cycle, and
the sine has measured what remains of it under an excitation of that size: bandwidth and margins
are computed, and not given as results.
"""

from collections.abc import Iterator, Sequence

from isa_ros.analysis.response.actuator_trace import RATE_HZ, Trace
from isa_ros.analysis.response.at_rest import HUNTS, LoopAtRest, rest_of, ticks_at_rest
from isa_ros.analysis.response.loops import CLOSED, Loop, OPEN, PLANT, UserUnit
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.response.sweep import Estimator, excitation, FrequencySweep
from isa_ros.analysis.signals.frequency import (
    bandwidth, HALF_POWER, Margins, margins, Response, TRUSTED)
from isa_ros.core.frozen import frozen
from isa_ros.text.table import aligned, RIGHT
import numpy as np


@frozen
class Bode:
    """A measured response, with bandwidth and margins from the same run."""

    loop: Loop
    of: str
    response: Response          # output over input in SI
    first_gain: float           # of the closed loop, at the lowest frequency
    bandwidth: float | None     # of the closed loop, relative to a gain of 1, Hz
    margins: Margins            # of the open loop
    amplitude: float            # of the reference, SI
    rest: LoopAtRest                  # the loop without excitation


def bode(rig: Rig, sweep: FrequencySweep, of: str, amplitude: float | None = None) -> Bode:
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
    actuator = rig.start()
    trace = rig.excite(actuator, peak * values, peak * rates)
    n_push, n_still = ticks_at_rest(RATE_HZ)
    still = rig.excite(actuator, peak * np.repeat([1.0, 0.0], [n_push, n_still]))
    return evaluate(loop, answer, of, peak, trace, rest_of(still[loop.name], peak, RATE_HZ))


def evaluate(
        loop: Loop, answer: Estimator, of: str, amplitude: float, trace: Trace,
        rest: LoopAtRest) -> Bode:
    """Return a loop's response from the trace of one run, and its ripple after it."""
    reference, y = trace[f'{loop.name}_reference'], trace[loop.name]
    closed, opened, requested = (
        answer.estimate(reference, loop.input_of(which, trace), y)
        for which in (CLOSED, OPEN, of))
    return Bode(
        loop, of, requested, float(closed.gain[0]), bandwidth(closed, dc_gain=1.0),
        margins(opened), amplitude, rest)


_HEAD = ('frequency, Hz', 'gain', 'gain, dB', 'phase, deg', 'coherence', 'in', 'out')
_UNTRUSTED = '!'    # in a row whose coherence is below `TRUSTED`


def table(measured: Bode) -> str:
    """Return a response as a table, followed by its bandwidth, margins and ripple."""
    loop, response = measured.loop, measured.response
    unit, into = loop.response_unit(measured.of), input_unit(measured)
    head = [*_HEAD[:1], f'gain, {unit.symbol}', *_HEAD[2:5],
            f'in, {into.symbol}', f'out, {loop.unit.symbol}', '']
    value = response.gain / unit.scale
    columns = zip(
        response.frequency, value, 20.0 * np.log10(value), response.phase, response.coherence,
        response.input_amplitude / into.scale, response.output_amplitude / loop.unit.scale,
        response.is_trusted)
    rows = [[f'{f:.4g}', f'{gain:.4g}', f'{db:.2f}', f'{phase:.1f}', f'{coherence:.4f}',
             f'{x:.4g}', f'{y:.4g}', '' if trusted else _UNTRUSTED]
            for f, gain, db, phase, coherence, x, y, trusted in columns]
    return '\n'.join([*aligned([head, *rows], RIGHT), *conclusions(measured)])


def conclusions(measured: Bode) -> Sequence[str]:
    """Return bandwidth, margins and ripple, and warnings, a line each."""
    lines = [*_figures(measured)] if not measured.rest.hunts else []
    lines.append(_ripple(measured))
    own = measured.loop.sheet.plant.valve
    if own.hysteresis_percent > 0.0:
        lines.append(
            f'the valve has {own.hysteresis_percent:g} % hysteresis: gain and phase are those of '
            'this amplitude; --set plant.valve.hysteresis_percent=0 '
            '--set plant.valve.threshold_percent=0 is the linear response')
    frequency, coherence = measured.response.frequency, measured.response.coherence
    least = int(coherence.argmin())
    if coherence[least] < TRUSTED:
        lines.append(
            f'coherence falls to {coherence[least]:.2g} at {frequency[least]:.4g} Hz; frequencies '
            f'with less than {TRUSTED:g}, marked {_UNTRUSTED}, are left out of bandwidth and '
            'margins')
    return lines


def _figures(measured: Bode) -> Iterator[str]:
    found, frequency = measured.margins, measured.response.frequency
    band = (f'{measured.bandwidth:.4g} Hz' if measured.bandwidth is not None
            else f'below {frequency[0]:.4g} Hz' if measured.first_gain < HALF_POWER
            else f'above {frequency[-1]:.4g} Hz')
    gain = ('none in this band' if found.gain_db is None
            else f'{found.gain_db:.1f} dB at {found.gain_frequency:.4g} Hz')
    phase = ('none in this band' if found.phase is None
             else f'{found.phase:.1f} deg at {found.phase_frequency:.4g} Hz')
    yield f'closed loop, -3 dB: {band}'
    yield f'open loop, gain margin: {gain}'
    yield f'open loop, phase margin: {phase}'


def _ripple(measured: Bode) -> str:
    rest, unit = measured.rest, measured.loop.unit
    if not rest.is_known:
        return 'at rest: not recorded, so that the loop may hunt'
    size = f'{rest.ripple / unit.scale:.3g} {unit.symbol}'
    share = f'{rest.share * 100.0:.2g} % of the excitation'
    if not rest.hunts:
        return f'at rest, ripple: {size}, {share}'
    return (f'the loop hunts: at rest it oscillates by {size} at {rest.frequency:.4g} Hz, {share} '
            f'(bound: {HUNTS * 100.0:g} %); bandwidth and margins are not given')


def input_unit(measured: Bode) -> UserUnit:
    """Return the unit of the response's input."""
    return measured.loop.inward_unit if measured.of == PLANT else measured.loop.unit
