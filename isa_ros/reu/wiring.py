"""
The REU's four control blocks: their variables and rates, and the combinations it refuses.

    position -> force or torque -> pressure difference -> spool -> current

Any of them may be off; the setpoint's effort then is the reference of the outermost block
that is on. With all but the current block off the REU is a plain valve amplifier. The gains of
a block have the unit of its output: switching the next block inwards on or off changes it.
"""

from isa_ros.core.device import CURRENT, MODES
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, fault, nested, parameter, Parameters, section
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP_NS, steps_in
from isa_ros.errors import ConfigError
from isa_ros.reu import dither
from isa_ros.reu.block import Pid
from isa_ros.reu.compensation import DeadBand, Linear
from isa_ros.reu.feedback_linearisation import FeedbackLinearisation
from isa_ros.reu.filters import SpeedEstimate
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.lead_lag import LeadLag
from isa_ros.reu.protection_sheet import Protection


@frozen(kw_only=True)
class Device(Parameters):
    """Times and movements of the device's states."""

    initialisation_ms: float = parameter(
        'from t = 0 until the outputs may be on', 'ms', ge=0.0, le=60e3)
    quick_stop: str = choice(
        'close: the valve to null at once (IEC 60204-1 category 0); ramp: from the speed to rest, '
        'then off (category 1); ramp_and_hold: stays at rest with the outputs on (category 2)',
        'close', 'ramp', 'ramp_and_hold')
    quick_stop_deceleration: float = parameter(
        'of the ramp of a quick stop or a hold; more before an end of the stroke',
        'm/s2 | rad/s2', gt=0.0, le=1e4)
    quick_stop_hold_ms: float = parameter(
        'at rest, before the outputs are off', 'ms', ge=0.0, le=60e3)
    return_speed: float = parameter(
        'at most, back to the setpoint after a hold or damp has ended', 'm/s | rad/s',
        absent=0.1, source='assumed', gt=0.0, le=100.0)
    fade_ms: float = parameter(
        'time constant of the rest of a jump between modes or gains', 'ms', gt=0.0, le=1e3)
    emergency_stop: float = fault(
        '1: the line of the emergency stop is open', '1', is_whole=True, ge=0.0, le=1.0)


BEFORE = Device(
    initialisation_ms=0.0, quick_stop='ramp', quick_stop_deceleration=10.0,
    quick_stop_hold_ms=200.0, return_speed=0.1, fade_ms=5.0)
"""Of a resolved configuration older than the device, which had none of its states."""


BLOCKS = 4  # in the standard firmware (paper section 3)
NEVER = 1 << 62  # plant steps: the period of a block that is off


@frozen(kw_only=True)
class Off(Parameters):
    """The block is not active; its reference goes to the next block inwards."""


@frozen(kw_only=True)
class Held(Parameters):
    """The block samples and holds its reference; its loop is closed in the plant's equations."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)


OFF, HELD, PID, IMPEDES, LINEARISES, LEADS_AND_LAGS = range(6)
KINDS: dict[type, int] = {
    Off: OFF, Held: HELD, dither.HeldWithDither: HELD, Pid: PID, Impedance: IMPEDES,
    FeedbackLinearisation: LINEARISES, LeadLag: LEADS_AND_LAGS}
"""The kinds of blocks as numbers, for the kernels."""


@frozen(kw_only=True)
class Reu(Parameters):
    """The control blocks by the variable they control, outermost first."""

    speed: SpeedEstimate
    position: Off | Impedance | Pid
    force: Off | Pid | FeedbackLinearisation
    pressure: Off | Pid
    spool: Off | Held | Pid
    current: dither.HeldWithDither | LeadLag
    device: Device = nested(BEFORE)
    computation_delay_us: float = parameter(
        'from an instant of the loops to its output at the amplifier', 'us', ge=0.0, le=1e3)
    frozen: float = fault(
        '1: the program of the REU has stopped, and its outputs hold', '1', is_whole=True,
        ge=0.0, le=1.0)
    watchdog_ms: float = parameter(
        'time without the program after which its output is switched off; 0: no watchdog', 'ms',
        absent=5.0, source='assumed', ge=0.0, le=1e3)
    protection: Protection = section(Protection)


VARIABLES = ('position', 'force', 'pressure', 'spool', 'current')
"""The variables a block may control, outermost first."""


def active(reu: Reu) -> dict[str, float]:
    """Return the rate (Hz) of every block that is on, by its variable, outermost first."""
    return {name: getattr(reu, name).rate_hz for name in VARIABLES
            if not isinstance(getattr(reu, name), Off)}


def refuse_nonsense(reu: Reu) -> None:
    """
    Refuse a set of blocks that an REU cannot run with any actuator.

    Raises
    ------
    ConfigError
        Too many blocks, an impedance without a force block, a block with a model of the valve
        that does not command it, rates that do not divide, or an invalid delay.

    """
    names = active(reu)
    if len(names) > BLOCKS:
        raise ConfigError(
            f'reu: {len(names)} control blocks are on ({", ".join(names)}), must be <= {BLOCKS}; '
            'set kind: off for the others')
    if isinstance(reu.position, Impedance) and isinstance(reu.force, Off):
        raise ConfigError(
            'reu.position.kind = impedance gives a force reference and reu.force.kind is off; '
            'set reu.position.kind: pid for pure position control')
    _refuse_far_from_valve(reu)
    delay_steps(reu, loop_steps(reu)['current'])


def block_of(mode: int, reu: Reu) -> Parameters:
    """Return the outermost block of a mode, which may be off or of another kind."""
    name = MODES[mode]
    block: Parameters = getattr(reu, 'position' if name == 'impedance' else name)
    return block


def possible_modes(reu: Reu) -> tuple[int, ...]:
    """Return the modes that the wiring has, innermost first."""
    return tuple(mode for mode in range(CURRENT, len(MODES)) if not why_impossible(mode, reu))


def first_mode(reu: Reu) -> int:
    """Return the mode with every block that is on, in which an actuator starts."""
    return possible_modes(reu)[-1]


def why_impossible(mode: int, reu: Reu) -> str:
    """Return why the wiring does not have a mode, or ''."""
    name, block = MODES[mode], block_of(mode, reu)
    if name == 'impedance' and not isinstance(block, Impedance):
        return 'reu.position.kind is not impedance'
    if name == 'position' and isinstance(block, Impedance):
        return 'reu.position.kind = impedance, must be pid'
    return f'reu.{name}.kind = off' if isinstance(block, Off) else ''


def mode_of(name: str, reu: Reu, where: str = 'mode') -> int:
    """
    Return the number of a mode.

    Raises
    ------
    ConfigError
        The mode does not exist, or the wiring does not have it.

    """
    if name not in MODES[CURRENT:]:
        raise ConfigError(f'{where} = {name!r} is unknown; {alternatives(name, MODES[CURRENT:])}')
    mode = MODES.index(name)
    if why := why_impossible(mode, reu):
        names = ', '.join(MODES[possible] for possible in possible_modes(reu))
        raise ConfigError(f'{where} = {name}: {why}; possible: {names}')
    return mode


def valve_block(reu: Reu) -> str | None:
    """Return the variable of the block that commands the valve's opening, None for none."""
    return next((name for name in ('pressure', 'force', 'position')
                 if not isinstance(getattr(reu, name), Off)), None)


def _refuse_far_from_valve(reu: Reu) -> None:
    at_valve = valve_block(reu)
    if isinstance(reu.force, FeedbackLinearisation) and at_valve != 'force':
        raise ConfigError(
            'reu.force.kind = feedback_linearisation commands the valve and reu.pressure.kind is '
            'pid; set reu.pressure.kind: off')
    for name in VARIABLES:
        sheet = getattr(reu, name)
        if (isinstance(sheet, Pid) and not isinstance(sheet.compensation, Linear)
                and name != at_valve):
            kind = 'dead_band' if isinstance(sheet.compensation, DeadBand) else 'dual_gain'
            raise ConfigError(
                f'reu.{name}.compensation.kind = {kind} inverts the flow curve of the valve, '
                f"which {f'reu.{at_valve}' if at_valve else 'no block'} commands; set "
                f'reu.{name}.compensation.kind: linear')


def loop_steps(reu: Reu) -> dict[str, int]:
    """
    Return the periods of the speed estimate and of all variables in plant steps.

    A block that is off has the period `NEVER`.

    Raises
    ------
    ConfigError
        A rate is not a whole number of plant steps, or an outer period not a
        whole number of the next inner one; both are named.

    """
    rates = {'speed': reu.speed.rate_hz} | active(reu)
    steps = {}
    for name, rate in rates.items():
        period_ns = NS_PER_SECOND / rate
        if not period_ns.is_integer():  # infinity is not an integer either
            raise ConfigError(
                f'{name}.rate_hz = {rate:g} Hz, its period must be whole nanoseconds')
        steps[name] = steps_in(int(period_ns), f'period of {name}.rate_hz = {rate:g} Hz')
    names = list(steps)
    for outer, inner in zip(names, names[1:]):
        if steps[outer] % steps[inner]:
            raise ConfigError(
                f'{outer}.rate_hz = {rates[outer]:g} Hz does not divide '
                f'{inner}.rate_hz = {rates[inner]:g} Hz')
    return {name: steps.get(name, NEVER) for name in ('speed', *VARIABLES)}


def delay_steps(reu: Reu, current_steps: int) -> int:
    """
    Return the computational delay in plant steps.

    Raises
    ------
    ConfigError
        It is not a whole number of plant steps, or as long as the current block's period.

    """
    steps = reu.computation_delay_us * 1e3 / PLANT_STEP_NS
    if steps != int(steps) or steps >= current_steps:
        raise ConfigError(
            f'computation_delay_us = {reu.computation_delay_us:g} us, must be a multiple of '
            f'{PLANT_STEP_NS / 1e3:g} us below {current_steps * PLANT_STEP_NS / 1e3:g} us, '
            'the period of the current loop')
    return int(steps)
