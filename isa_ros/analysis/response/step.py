"""`isa step`: the step response of one loop, its figures and its signals."""

from isa_ros.analysis.response.actuator_trace import RATE_HZ, Trace
from isa_ros.analysis.response.at_rest import HUNTS
from isa_ros.analysis.response.loops import Loop
from isa_ros.analysis.response.rig import Rig
from isa_ros.analysis.signals.step_response import step_figures, StepFigures, TAIL
from isa_ros.analysis.signals.swing import Swing, swing
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError
from isa_ros.loads.drop_rig import Wheel
import numpy as np

BEFORE = 0.1                # time before the step over the duration
SHORTEST_S, LONGEST_S = 0.01, 100.0
BAND = 0.05                 # settling band over the step
MOVED = 0.01                # of the travel; an end that is nearer is where it starts
_DECAYS = 1.25              # of a swing a tenth of the time before; more: it decays
LOST = 0.5                  # error or ripple at the end over the step; above: it does not follow


@frozen
class StepResponse:
    """A measured step: signals over time from the step on, (n,), SI, and its figures."""

    loop: Loop
    amplitude: float
    t: np.ndarray
    reference: np.ndarray
    output: np.ndarray
    inward: np.ndarray | None
    figures: StepFigures
    standing_error: float
    """
    Reference less output at the step, as of a load that a loop without integrator carries.

    0.0: within `BAND` of the step, or the output swings. Else the figures are of the change from
    there.
    """

    @property
    def swing(self) -> Swing:
        """Return the swing of the last tenth, of more than `HUNTS`, that does not decay."""
        n = round(TAIL * np.count_nonzero(self.t >= 0.0))
        before, found = (swing(self.t[part], self.output[part], HUNTS * abs(self.amplitude))
                         for part in (slice(-2 * n, -n), slice(-n, None)))
        return found if before.size < _DECAYS * found.size else Swing(0.0, 0.0)

    @property
    def hunts(self) -> bool:
        """Return whether the output swings on, or drift aside deviates by more than `LOST`."""
        n = round(TAIL * np.count_nonzero(self.t >= 0.0))
        t, output = self.t[-n:], self.output[-n:]
        return self.swing.size > 0.0 or bool(
            (output - _drift(t, output)(t)).std() > LOST * abs(self.amplitude))

    @property
    def follows(self) -> bool:
        """Return whether error and ripple at the end are within `LOST` of the step."""
        return max(abs(self.figures.steady_error), self.figures.ripple) <= LOST * abs(
            self.amplitude)


def step(rig: Rig, duration: float, amplitude: float | None = None) -> StepResponse:
    """
    Measure a step of a loop's reference by ``amplitude`` (in the loop's unit) from rest.

    Raises
    ------
    ConfigError
        The duration or the amplitude is out of range, or the piston runs into an end.
    SimulationDiverged
        A state is no longer finite.

    """
    check_duration(duration)
    peak = rig.amplitude(amplitude)
    before = round(BEFORE * duration * RATE_HZ)
    values = np.full(before + round(duration * RATE_HZ), peak)
    values[:before] = 0.0
    trace = rig.excite(rig.start(), values)
    _refuse_end_stop(rig, trace['position'][before:])
    return evaluate(rig.loop, trace, before, rig.offset, peak, RATE_HZ)


def _refuse_end_stop(rig: Rig, position: np.ndarray) -> None:
    """
    Refuse a step in which the piston runs into an end of its travel; ``position`` is from it on.

    Raises
    ------
    ConfigError
        It does: what follows is a response of the stop.

    """
    config = rig.config
    low, high = 0.0, config.sheet.plant.drive.stroke
    if isinstance(config.load, Wheel):
        low, high = max(low, config.load.stop_low), min(high, config.load.stop_high)
    is_at_end = (position <= low) | (position >= high)
    moved = np.abs(position - position[0]) > MOVED * (high - low)
    if np.any(is_at_end & moved):
        k = int(np.argmax(is_at_end & moved))
        raise ConfigError(
            f'{config.name}: runs into the end of its travel {k / RATE_HZ * 1e3:.0f} ms after the '
            'step, so that there are no figures of the loop; choose a shorter --duration, a '
            'smaller --amplitude, or --load blocked')


def check_duration(duration: float) -> None:
    """Refuse a recording that is too short for its figures or unreasonably long."""
    if not SHORTEST_S <= duration <= LONGEST_S:
        raise ConfigError(
            f'--duration = {duration:g} s, must be {SHORTEST_S:g} to {LONGEST_S:g} s')


def evaluate(
        loop: Loop, trace: Trace, before: int, start: float, amplitude: float,
        rate: float) -> StepResponse:
    """Return a step of a reference that stood at ``start``, at row ``before`` > 0 of a trace."""
    output = trace[loop.name]
    t = (np.arange(len(output)) - before) / rate
    standing = _standing_error(t[:before], output[:before], start, BAND * abs(amplitude))
    start -= standing
    return StepResponse(
        loop, amplitude, t, trace[f'{loop.name}_reference'], output,
        None if loop.inward is None else trace[loop.inward],
        step_figures(t[before:], output[before:], start, start + amplitude, BAND), standing)


def _standing_error(t: np.ndarray, output: np.ndarray, start: float, band: float) -> float:
    """Return ``start`` less the output at t = 0, by the half of the time before it; 0.0: none."""
    t, output = t[len(t) // 2:], output[len(t) // 2:]
    drift = _drift(t, output)
    standing = start - float(drift(0.0))
    return 0.0 if np.ptp(output - drift(t)) > band or abs(standing) <= band else standing


def _drift(t: np.ndarray, output: np.ndarray) -> np.polynomial.Polynomial:
    """Return the straight line through an output."""
    return np.polynomial.Polynomial.fit(t, output, min(1, len(t) - 1))


def summary(measured: StepResponse) -> str:
    """Return the figures of a step, a line each."""
    found, unit = measured.figures, measured.loop.unit

    def time(value: float | None) -> str:
        return 'not within the recording' if value is None else f'{value * 1e3:.4g} ms'

    lines = [
        f'rise time, 10 to 90 %: {time(found.rise_time)}',
        f'overshoot: {found.overshoot * 100.0:.3g} %',
        f'settling time, into +-{BAND * 100.0:g} %: {time(found.settling_time)}',
        f'steady error, mean of the last tenth: {found.steady_error / unit.scale:.3g} '
        f'{unit.symbol}',
        f'ripple, deviation over the last tenth: {found.ripple / unit.scale:.3g} {unit.symbol}']
    if measured.standing_error:
        side = 'short of' if measured.standing_error * measured.amplitude > 0.0 else 'beyond'
        lines.append(
            f'at the step it was {abs(measured.standing_error) / unit.scale:.3g} '
            f'{unit.symbol} {side} its reference: all figures are of the change from there')
    if measured.swing.size:
        size, hertz = measured.swing
        lines.append(
            f'the loop hunts: at the end it swings by +-{size / unit.scale:.3g} {unit.symbol} at '
            f'{hertz:.3g} Hz, {100.0 * size / abs(measured.amplitude):.3g} % of the step')
    if not measured.follows:
        lines.append(f'error or ripple at the end exceeds {LOST * 100.0:g} % of the step: the '
                     'loop does not follow, or the recording is too short')
    return '\n'.join(lines)
