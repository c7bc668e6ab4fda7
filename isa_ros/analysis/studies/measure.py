"""
The measures of a study at each value, on the bare actuator.

- Output blocked, steps of 10 % of the rating and back, at mid stroke and near the stop at its
  end, where the oil is stiffest: rise, overshoot, and the ripple left 0.8 s after.
- Sines of the same amplitude at mid stroke: the frequency of -3 dB of the closed loop.
- On the wheel under its impedance gains, a joint of a leg that trots at 1 m/s, and then stands:
  the errors of torque and position, and the ripple while it stands.

A ripple is half of peak to peak; for one beyond `SMALL` of the step the frequency is given.
"""

from dataclasses import replace
import math

from isa_ros.actuator.sheet import refuse_wiring
from isa_ros.analysis.response.actuator_trace import RATE_HZ
from isa_ros.analysis.response.bode import bode
from isa_ros.analysis.response.loops import loop_of
from isa_ros.analysis.response.rig import BLOCKED, Choice, Rig, rig
from isa_ros.analysis.response.sweep import FrequencySweep
from isa_ros.analysis.signals.frequency import ripple, ripple_frequency
from isa_ros.analysis.signals.step_response import step_figures
from isa_ros.analysis.studies.studies import Case, Study
from isa_ros.config.runs.changed_parameters import Values, with_parameters
from isa_ros.config.text.sections import Place
from isa_ros.core.frozen import frozen
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.scenario.trot import smooth_step
from isa_ros.scenario.trot_motion import read_gait
from isa_ros.text.progress import Progress
import numpy as np

SMALL = 0.02            # of the step: up to three quanta of the torque sensor
PLACES = (0.5, 0.02)    # of the stroke: steps at mid stroke and near the stop
STEP_S = 1.2            # up, and as long back
RIPPLE_S = 0.4          # at the end of each
SHOWN_S = 0.1           # of a step in a figure
SWEEP = FrequencySweep(low=10.0, high=160.0, points=9)
WHEEL = 'wheel'
LOAD = 'load.'          # prefix of a parameter of the blocked output
TROT_JOINTS = {'smart_manifold': 'hfe', 'isa_v5': 'kfe'}     # joint of the trot by model
ROUNDING = 1e-9         # of a value in its unit
SETPOINT_NS = 1_000_000     # between setpoints of a run
GROWN_S, TROT_S, FADE_S, STAND_S = 0.6, 1.2, 0.3, 0.9   # 0.6 s: start_s of the packaged trot


@frozen(kw_only=True)
class MeasuresAt:
    """The measures at one value, in the units of the page."""

    value: float
    rise: float | None          # ms, 10 to 90 %
    overshoot: float            # percent
    bandwidth: float | None     # Hz; None: outside of `SWEEP`
    ripple_mid: float           # N | Nm, blocked at mid stroke
    ripple_end: float           # the same near the stop
    ripple_wheel: float         # standing on the wheel
    ripple_hz: float | None     # of the largest ripple; None: none beyond `SMALL`
    force_error: float          # N | Nm rms in the trot
    position_error: float       # mm | mrad rms in the trot
    step: np.ndarray            # force from the step on, as a share of it, at `RATE_HZ`


@frozen
class StudyRig:
    """The actuator of a case as shipped, on both loads, and the trot it follows."""

    blocked: Rig
    wheel: Rig
    positions: np.ndarray   # of the trot and its end, around the start, m | rad, (n,)
    velocities: np.ndarray


class Benches:
    """The benches of several studies: cases that differ only in their values share one."""

    def __init__(self) -> None:
        self._of: dict[tuple[str, tuple[str, ...]], StudyRig] = {}

    def of(self, case: Case) -> StudyRig:
        """Return the bench of a case."""
        key = case.model, case.variants
        if key not in self._of:
            blocked, wheel = (rig(Choice(
                name=case.model, loop='position', preset=case.preset, variants=case.variants,
                load=load)) for load in (BLOCKED, WHEEL))
            self._of[key] = StudyRig(blocked, wheel, *_trot(case.model, wheel))
        return self._of[key]


@frozen
class Studied:
    """A case, the value of its shipped actuator, and the outcomes at all values."""

    case: Case
    shipped: float
    amplitude: float    # of the step, N | Nm
    outcomes: tuple[MeasuresAt, ...]
    is_rotary: bool

    @property
    def force_unit(self) -> str:
        """Return the unit of forces and torques."""
        return 'Nm' if self.is_rotary else 'N'

    @property
    def position_unit(self) -> str:
        """Return the unit of positions."""
        return 'mrad' if self.is_rotary else 'mm'

    def is_shipped(self, outcome: MeasuresAt) -> bool:
        """Return whether an outcome is that of the shipped actuator, up to rounding."""
        return math.isclose(outcome.value, self.shipped, rel_tol=ROUNDING)


def results(
        study: Study, benches: Benches, progress: Progress | None = None) -> tuple[Studied, ...]:
    """
    Measure all cases of a study.

    Raises
    ------
    ConfigError
        A value is outside its declared range, or the rates do not divide.
    SimulationDiverged
        A state is no longer finite.

    """
    total, done, found = sum(len(case.values) for case in study.cases), 0, []
    for case in study.cases:
        on, outcomes = benches.of(case), []
        for value in case.values:
            outcomes.append(measured(case, on, value))
            done += 1
            if progress is not None:
                progress(done, total)
        sheet = on.blocked.config.sheet
        found.append(Studied(
            case, shipped(case, on), loop_of(sheet, 'force').amplitude, tuple(outcomes),
            sheet.is_rotary))
    return tuple(found)


def shipped(case: Case, on: StudyRig) -> float:
    """Return the value that the shipped actuator has."""
    path, share = case.paths[0]
    found: object = on.blocked.config if path.startswith(LOAD) else on.blocked.config.sheet
    for name in path.split('.'):
        found = getattr(found, name)
    assert isinstance(found, (int, float))
    return found / (share * case.unit.scale)


def measured(case: Case, on: StudyRig, value: float) -> MeasuresAt:
    """Measure a case at one value; as `results`."""
    parameters = case.parameters(value)
    blocked = changed(on.blocked, 'force', parameters)
    wheel = changed(on.wheel, 'position', {
        path: number for path, number in parameters.items() if not path.startswith(LOAD)})
    amplitude = blocked.loop.amplitude
    mid, end = (up_and_back(placed(blocked, place)) for place in PLACES)
    trace = wheel.excite(wheel.start(), on.positions, on.velocities)
    trotting = slice(round(GROWN_S * RATE_HZ), round((GROWN_S + TROT_S) * RATE_HZ))
    last = slice(-round(RIPPLE_S * RATE_HZ), None)
    rests = [part[last] for part in (*mid, *end, trace['force'])]
    ripples = [ripple(rest) for rest in rests]
    largest = int(np.argmax(ripples))
    figures = step_figures(np.arange(len(mid[0])) / RATE_HZ, mid[0], 0.0, amplitude)
    return MeasuresAt(
        value=value,
        rise=None if figures.rise_time is None else figures.rise_time * 1e3,
        overshoot=figures.overshoot * 100.0, bandwidth=bode(blocked, SWEEP, 'closed').bandwidth,
        ripple_mid=max(ripples[:2]), ripple_end=max(ripples[2:4]), ripple_wheel=ripples[4],
        ripple_hz=(ripple_frequency(rests[largest], RATE_HZ)
                   if ripples[largest] > SMALL * amplitude else None),
        force_error=_rms((trace['force'] - trace['force_reference'])[trotting]),
        position_error=_rms((trace['position'] - trace['position_reference'])[trotting]) / MILLI,
        step=mid[0][:round(SHOWN_S * RATE_HZ)] / amplitude)


def changed(given: Rig, loop: str, parameters: Values) -> Rig:
    """Return a rig with some parameters replaced, and with one of its loops outermost."""
    config = with_parameters(given.config, parameters, given.run.source)
    refuse_wiring(config.sheet)
    made = loop_of(config.sheet, loop)
    return replace(given, loop=made).with_config(replace(config, sheet=made.sheet))


def placed(blocked: Rig, place: float) -> Rig:
    """Return a rig at a position given as a share of the stroke."""
    stroke = blocked.config.sheet.plant.drive.stroke
    return blocked.with_config(replace(blocked.config, initial_position=place * stroke))


def up_and_back(blocked: Rig) -> tuple[np.ndarray, np.ndarray]:
    """Return the force (N | Nm) from a step of the loop's amplitude on, and from that back."""
    n = round(STEP_S * RATE_HZ)
    values = np.zeros(2 * n)
    values[:n] = blocked.loop.amplitude
    force: np.ndarray = blocked.excite(blocked.start(), values)['force']
    return force[:n], force[n:]


def _trot(model: str, wheel: Rig) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and velocities of a trot, held as a run holds its setpoints."""
    gait = read_gait(
        {'joint': TROT_JOINTS[model], 'feed_forward': 0.0}, Place('trot'), wheel.config, None,
        wheel.config.initial_position)
    period = SETPOINT_NS / NS_PER_SECOND
    rows = []
    for k in range(round((GROWN_S + TROT_S + FADE_S + STAND_S) / period)):
        excursion = gait.at(k * SETPOINT_NS)
        u = min(1.0, max(0.0, (k * period - GROWN_S - TROT_S) / FADE_S))
        w, slope, _ = smooth_step(u)
        rows.append((
            (1.0 - w) * excursion.position,
            (1.0 - w) * excursion.velocity - slope / FADE_S * excursion.position))
    positions, velocities = np.repeat(rows, round(period * RATE_HZ), axis=0).T
    return positions, velocities


def _rms(error: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(error))))
