"""
Motions: values added to a setpoint from its event until the next one.

Times are integer ns since the event. A motion of the position changes the velocity as well, so
that the damping of the impedance does not brake it; one of the effort changes the effort only.
"""

from abc import ABC, abstractmethod
import math
from typing import ClassVar, NamedTuple, Protocol

from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.parameter_sets import as_tree
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.elementary import cos, exp, expm1, log, sin
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check, choice, parameter, Parameters
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import of_coordinate
from isa_ros.errors import ConfigError, ParameterError

POSITION, EFFORT = 'position', 'effort'
MOVES = 'moves'
MAX_POSITION = 10.0   # m | rad, a bound against typing errors
MAX_EFFORT = 1e8      # N, Nm or Pa, likewise
_MOVED = {POSITION: ('m | rad', MAX_POSITION), EFFORT: ('N | Nm', MAX_EFFORT)}
"""Unit and largest amplitude of what a waveform moves."""
TWO_PI = 2.0 * math.pi


class Excursion(NamedTuple):
    """Values that a motion adds to position, velocity and effort of its setpoint, SI."""

    position: float
    velocity: float
    effort: float


class SetpointMotion(Protocol):
    """A motion of the setpoint after an event."""

    def at(self, t_ns: int) -> Excursion:
        """Return the excursion ``t_ns`` after the event."""
        ...

    def reach(self) -> tuple[Excursion, Excursion]:
        """Return the least and the greatest position, velocity and effort that it ever has."""
        ...

    def tree(self) -> Tree:
        """Return its section of a scenario file."""
        ...


@frozen(kw_only=True)
class Waveform(Parameters, ABC):
    """Parameters of every waveform; by default it moves the position."""

    ENDS: ClassVar[tuple[float, float]] = (-1.0, 1.0)
    """Least and greatest value, in amplitudes."""

    moves: str = choice('quantity it is added to', POSITION, EFFORT)
    amplitude: float = parameter('amplitude', 'm | rad | N | Nm', ge=-MAX_EFFORT, le=MAX_EFFORT)

    def tree(self) -> Tree:
        """Return its section of a scenario file."""
        return as_tree(self)

    def reach(self) -> tuple[Excursion, Excursion]:
        """Return the least and the greatest excursion; each has extremes of different times."""
        least, greatest = zip(self.ENDS, self._rates)
        if self.amplitude < 0.0:
            least, greatest = greatest, least
        return self._excursion(*least), self._excursion(*greatest)

    @property
    def _rates(self) -> tuple[float, float]:
        """Return the least and the greatest rate that is commanded, amplitudes per second."""
        return 0.0, 0.0

    @abstractmethod
    def at(self, t_ns: int) -> Excursion:
        """Return the excursion ``t_ns`` after the event."""

    @abstractmethod
    def refuse_step(self, step_ns: int, where: str) -> None:
        """
        Refuse a waveform that setpoints ``step_ns`` apart cannot represent.

        Raises
        ------
        ConfigError
            A frequency above half the rate of the setpoints, or a time between two of them.

        """

    def _excursion(self, value: float, rate: float) -> Excursion:
        """Return the amplitude times a value and its rate."""
        if self.moves == EFFORT:
            return Excursion(0.0, 0.0, self.amplitude * value)
        return Excursion(self.amplitude * value, self.amplitude * rate, 0.0)


@frozen(kw_only=True)
class Sine(Waveform):
    """A sine from its setpoint on."""

    frequency_hz: float = parameter('frequency', 'Hz', gt=0.0, le=5e3)

    @property
    def _rates(self) -> tuple[float, float]:
        omega = TWO_PI * self.frequency_hz
        return -omega, omega

    def at(self, t_ns: int) -> Excursion:
        """Return A sin(omega t) and A omega cos(omega t)."""
        omega = TWO_PI * self.frequency_hz
        phase = omega * (t_ns / NS_PER_SECOND)
        return self._excursion(sin(phase), omega * cos(phase))

    def refuse_step(self, step_ns: int, where: str) -> None:
        """Refuse a sine that the setpoints would alias."""
        _refuse_alias(self.frequency_hz, step_ns, f'{where}.frequency_hz')


@frozen(kw_only=True)
class Chirp(Waveform):
    """A sine from one frequency to another; it stays at the end frequency."""

    start_hz: float = parameter('frequency at its setpoint', 'Hz', gt=0.0, le=5e3)
    end_hz: float = parameter('frequency after duration_s', 'Hz', gt=0.0, le=5e3)
    duration_s: float = parameter('time from one to the other', 's', gt=0.0, le=1e5)
    sweep: str = choice('how the frequency changes', 'linear', 'exponential')

    def __post_init__(self) -> None:
        """Refuse a chirp of a single frequency, which is a sine."""
        super().__post_init__()
        if self.start_hz == self.end_hz:
            raise ParameterError(
                f'Chirp.end_hz = {self.end_hz:g} Hz, must differ from start_hz (else: sine)')

    @property
    def _rates(self) -> tuple[float, float]:
        omega = TWO_PI * max(self.start_hz, self.end_hz)
        return -omega, omega

    def phase(self, t: float) -> tuple[float, float]:
        """
        Return the phase, rad, and its rate, rad/s, at ``t`` in s: the integral in closed form.

        Linear f = f_0 + (f_1 - f_0) t/T, exponential f = f_0 (f_1/f_0)^(t/T).
        """
        swept = min(t, self.duration_s)
        if self.sweep == 'linear':
            slope = (self.end_hz - self.start_hz) / self.duration_s
            cycles = swept * (self.start_hz + 0.5 * slope * swept)
            frequency = self.start_hz + slope * swept
        else:
            growth = log(self.end_hz / self.start_hz) / self.duration_s
            cycles = self.start_hz * expm1(growth * swept) / growth
            frequency = self.start_hz * exp(growth * swept)
        return TWO_PI * (cycles + self.end_hz * (t - swept)), TWO_PI * frequency

    def at(self, t_ns: int) -> Excursion:
        """Return A sin(phase) and A phase' cos(phase)."""
        phase, rate = self.phase(t_ns / NS_PER_SECOND)
        return self._excursion(sin(phase), rate * cos(phase))

    def refuse_step(self, step_ns: int, where: str) -> None:
        """Refuse a chirp that the setpoints would alias at one of its ends."""
        for key in ('start_hz', 'end_hz'):
            _refuse_alias(getattr(self, key), step_ns, f'{where}.{key}')


@frozen(kw_only=True)
class Pulse(Waveform):
    """A train of steps: the amplitude for a width, then zero until the period is over."""

    ENDS = (0.0, 1.0)

    period_s: float = parameter('from one step to the next', 's', gt=0.0, le=1e5)
    width_s: float = parameter('of a step', 's', gt=0.0, le=1e5)

    def __post_init__(self) -> None:
        """Refuse a step as long as its period."""
        super().__post_init__()
        if not self.width_s < self.period_s:
            raise ParameterError(
                f'Pulse.width_s = {self.width_s:g} s, must be < period_s = {self.period_s:g} s')

    def at(self, t_ns: int) -> Excursion:
        """Return A during a step; the velocity of its edges is not commanded."""
        is_up = t_ns % round(self.period_s * NS_PER_SECOND) < round(self.width_s * NS_PER_SECOND)
        return self._excursion(float(is_up), 0.0)

    def refuse_step(self, step_ns: int, where: str) -> None:
        """Refuse edges between two setpoints."""
        ticks_in(self.period_s, step_ns, f'{where}.period_s')
        ticks_in(self.width_s, step_ns, f'{where}.width_s')


@frozen(kw_only=True)
class Way(Waveform):
    """A way at constant rate to the amplitude, where it stays."""

    ENDS = (0.0, 1.0)

    duration_s: float = parameter('time to the amplitude', 's', gt=0.0, le=1e5)

    @property
    def _rates(self) -> tuple[float, float]:
        return 0.0, 1.0 / self.duration_s

    def at(self, t_ns: int) -> Excursion:
        """Return A t/T and A/T, from T on A and 0."""
        t = t_ns / NS_PER_SECOND
        if t >= self.duration_s:
            return self._excursion(1.0, 0.0)
        return self._excursion(t / self.duration_s, 1.0 / self.duration_s)

    def refuse_step(self, step_ns: int, where: str) -> None:
        """Refuse an end between two setpoints."""
        ticks_in(self.duration_s, step_ns, f'{where}.duration_s')


WAVEFORMS: dict[str, type[Waveform]] = {'sine': Sine, 'chirp': Chirp, 'pulse': Pulse}
"""Of setpoints, and of the values of faults."""
OF_SETPOINTS: dict[str, type[Waveform]] = {**WAVEFORMS, 'ramp': Way}


def refuse_amplitude(section: Tree, where: str, is_rotary: bool) -> None:
    """
    Refuse an amplitude out of the range of what it moves, in the unit of the actuator.

    Raises
    ------
    ParameterError
        It is more than `MAX_POSITION` or `MAX_EFFORT`: most likely in another unit.

    """
    moves = section.get(MOVES, POSITION)
    if moves in _MOVED and 'amplitude' in section:
        unit, largest = _MOVED[moves]
        check(f'{where}.amplitude', section['amplitude'], {
            'doc': f'of the {moves}', 'unit': of_coordinate(unit, is_rotary),
            'bounds': {'ge': -largest, 'le': largest}})


def _refuse_alias(frequency_hz: float, step_ns: int, where: str) -> None:
    highest = 0.5 * NS_PER_SECOND / step_ns
    if frequency_hz > highest:
        raise ConfigError(
            f'{where} = {frequency_hz:g} Hz, must be <= {highest:g} Hz, half the rate of '
            f'step_ms = {step_ns / 1e6:g} ms')
