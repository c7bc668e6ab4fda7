"""Key figures of a run: landing of a body; motion, peaks, tracking, ripple of each actuator."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from isa_ros.analysis.signals.frequency import ripple
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.units import LITRE, MILLI, MPA
from isa_ros.plant.hose_sheets import LumpedHoses
from isa_ros.reu.wiring import active
from isa_ros.text.table import Cells, digits
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SETTLED = 0.02  # of the motion: the usual band about the final value
END = 0.1       # of the time, in which what has settled is looked at for ripple
SHOWN = 0.1     # MPa, the last digit of a pressure
TOUCHES = 1.0   # N: a smaller force of the ground is no contact
HEADER = ('', 'from', 'to', '', 'speed, 1/s', 'peak force', '', 'pressure, MPa',
          'position error', 'force error', 'settled, s', 'ripple', 'oil, l')
LANDING_HEADER = ('contact', 'landing, s', 'peak magnitude, N', 'at, s', 'in contact')
LEGEND = (
    'speed and peak: greatest magnitudes; pressure: gauge, of the sensors at the valve; behind '
    'hoses also the peak in a chamber where it is higher; error: of reference and measurement, '
    'rms and at most, where a loop has both; settled: within 2 % of the motion; ripple: half of '
    'peak to peak of the force in the last tenth of the time, if settled; oil: drawn from the '
    'supply')


class TrackingError(NamedTuple):
    """How far a measurement is from its reference, SI."""

    rms: float
    most: float
    t_s: float
    """When it is greatest."""


class Landing(NamedTuple):
    """The first contact of a foot after it was in the air, and its greatest force."""

    body: str
    contact: str
    t_s: float | None
    """None: it touched from the beginning, or never."""
    peak: float
    """Magnitude, N."""
    peak_t_s: float
    share: float
    """Of the time in contact."""


def settling_time(t: Floats, x: Floats) -> float | None:
    """
    Return the time from which on ``x`` stays within 2 % of its range about its last value.

    None: it does not move, or has not settled before the last tenth of the time.
    """
    band = SETTLED * float(np.ptp(x))
    outside = np.flatnonzero(np.abs(x - x[-1]) > band)
    if band == 0.0 or outside.size == 0:
        return None
    settled = float(t[outside[-1] + 1])
    return settled if settled < t[0] + (1.0 - END) * (t[-1] - t[0]) else None


def end_of(signal: Signal) -> Signal:
    """Return a signal in the last tenth of its time."""
    t, values = signal
    is_last = t >= t[-1] - END * (t[-1] - t[0]) if len(t) else np.zeros(0, np.bool_)
    return Signal(t[is_last], values[is_last])


def error_of(signals: Signals, actuator: str, field: str) -> tuple[Floats, Floats] | None:
    """Return times and reference less measurement, SI, (n,) each; None: not recorded together."""
    measured = signals.drawn(f'{actuator}.{field}')
    reference = signals.drawn(f'{actuator}.{field}_reference')
    if not len(measured.t) or not np.array_equal(measured.t, reference.t):
        return None
    return measured.t, reference.values - measured.values


def tracking_error(error: tuple[Floats, Floats]) -> TrackingError:
    """Return the figures of an error over time."""
    t, values = error
    k = int(np.argmax(np.abs(values)))
    return TrackingError(
        float(np.sqrt(np.mean(values * values))), float(abs(values[k])), float(t[k]))


def landings(signals: Signals) -> Iterator[Landing]:
    """Yield the contacts of the run's bodies that were recorded."""
    for body in signals.run.bodies:
        for name in contacts_of(body):
            signal = signals.drawn(f'{body.name}.{name}')
            if len(signal.t):
                yield _landing(body, name, signal.t, np.linalg.norm(signal.values[:, :3], axis=1))


def landing_rows(signals: Signals) -> list[Cells]:
    """Return a row for each contact, the header first; empty without contacts."""
    rows = [(f'{own.body}.{own.contact}', '-' if own.t_s is None else f'{own.t_s:.3f}',
             digits(own.peak, 4), f'{own.peak_t_s:.3f}', f'{100.0 * own.share:.0f} %')
            for own in landings(signals)]
    return [LANDING_HEADER, *rows] if rows else []


def contacts_of(body: BodyConfig) -> list[str]:
    """Return the fields of a body that are forces of contacts, or begin with one."""
    return [field.name for field in body.fields
            if field.unit in ('N', 'N, Nm') and field.shape in ((3,), (6,))
            and field.name.endswith(('force', 'wrench'))]


def _landing(body: BodyConfig, name: str, t: Floats, force: Floats) -> Landing:
    is_down = force > TOUCHES
    first = np.flatnonzero(is_down[1:] & ~is_down[:-1])
    peak = int(np.argmax(force))
    return Landing(body.name, name, float(t[first[0] + 1]) if len(first) else None,
                   float(force[peak]), float(t[peak]), float(np.mean(is_down)))


def key_rows(signals: Signals) -> list[Cells]:
    """Return a row for each actuator, below `HEADER`."""
    return [HEADER, *(_row(signals, own) for own in signals.run.actuators)]


def shown_position(own: ActuatorConfig) -> tuple[float, str]:
    """Return by what a position in m or rad is multiplied for readers, and its unit then."""
    return (float(np.degrees(1.0)), 'deg') if own.sheet.is_rotary else (1 / MILLI, 'mm')


def _row(signals: Signals, own: ActuatorConfig) -> Sequence[str]:
    scale, unit = shown_position(own)

    def of(field: str) -> Floats:
        return signals.drawn(f'{own.name}.{field}').values
    x = of('position')
    oil, settled = of('supply_volume'), _settled(signals, own)
    newton = signals.unit(f'{own.name}.force')
    return (
        own.name, *((f'{x.min() * scale:.1f}', f'{x.max() * scale:.1f}') if len(x) else '--'),
        unit, _peak(of('velocity') * scale), _peak(of('force')), newton,
        pressure_range(signals, own),
        _error(signals, own, 'position', scale, unit), _error(signals, own, 'force', 1.0, newton),
        '-' if settled is None else f'{settled:.3f}',
        '-' if settled is None else _ripple(signals.drawn(f'{own.name}.force')),
        f'{oil[-1] / LITRE:.3f}' if len(oil) else '-')


def pressure_range(signals: Signals, own: ActuatorConfig) -> str:
    """
    Return the range of the sensors' pressures in MPa; behind hoses also the peak in a chamber.

    The sensors are at the valve: behind hoses and load-holding valves, which need hoses, a chamber
    has another pressure. It is given where it was recorded, and is the higher one.
    """
    def of(field: str) -> Floats:
        return np.concatenate([
            signals.drawn(f'{own.name}.{field}_{side}').values for side in 'ab']) / MPA
    sensed = of('pressure')
    if not len(sensed):
        return '-'
    text = f'{sensed.min():.1f} to {sensed.max():.1f}'
    if isinstance(own.sheet.plant.hoses, LumpedHoses):
        chambers = of('chamber_pressure')
        if len(chambers) and chambers.max() - sensed.max() >= SHOWN:
            text += f', chamber {chambers.max():.1f}'
    return text


def _settled(signals: Signals, own: ActuatorConfig) -> float | None:
    position = signals.drawn(f'{own.name}.position')
    return settling_time(position.t, position.values) if len(position.t) else None


def _ripple(force: Signal) -> str:
    """Return the ripple in the last tenth of the time; '-' if nothing was recorded there."""
    tail = end_of(force).values
    return digits(ripple(tail), 2) if len(tail) else '-'


def _peak(values: Floats) -> str:
    return digits(float(np.abs(values).max()), 3) if len(values) else '-'


def _error(signals: Signals, own: ActuatorConfig, field: str, scale: float, unit: str) -> str:
    """Return rms and greatest error of a loop with their unit; '-' if it is off."""
    error = error_of(signals, own.name, field) if field in active(own.sheet.reu) else None
    if error is None:
        return '-'
    found = tracking_error(error)
    return f'{digits(found.rms * scale, 3)}, {digits(found.most * scale, 3)} {unit}'
