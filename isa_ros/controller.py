"""
A user's controller in the lockstep: the state of tick k in, the setpoints of tick k + 1 out.

Independent of ROS; with `isa_ros.nodes.Participant` a controller takes part in a run.
"""

from collections.abc import Mapping, Sequence
from inspect import signature
import math
from typing import Any, NamedTuple

from isa_ros.core.device import FORCE, IMPEDANCE, MODES, POSITION, REFERENCES
from isa_ros.core.signals import (
    COMMAND, GAINS_OF_COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_QUICK_STOP,
    HAS_REFERENCE, HAS_SETPOINT, Records, SAMPLE)
from isa_ros.core.suggest import listed, shortened
from isa_ros.errors import ConfigError, RunError, SetpointError
import numpy as np
from numpy.typing import ArrayLike, NDArray


class State(NamedTuple):
    """The state of a run at one instant; the next tick overwrites the records."""

    t_ns: int
    actuators: Mapping[str, np.record]
    """`SAMPLE` by actuator: ``state.actuators['knee'].position``; SI, pressures gauge."""
    supplies: Mapping[str, np.record]
    """`SUPPLY_SAMPLE` by supply: ``state.supplies['supply'].pressure``, Pa gauge."""
    bodies: Mapping[str, np.record]
    """
    The sample of each body that actuators move, by its name.

    Of a leg: ``position``, ``velocity``, ``torque`` of its joints, ``foot_force``, ... (3,).
    """
    rows: Records = np.zeros(0, SAMPLE)
    """The same of all actuators, (n_actuators,): ``state.rows['position']`` in their order."""

    @property
    def body(self) -> np.record | None:
        """Return the sample of the only body; None without one, or with several."""
        return only_of(self.bodies)


class Setpoint(NamedTuple):
    """
    The command to one actuator; m, m/s, N, N/m, Ns/m or rad, rad/s, Nm, ...

    With a position it is an impedance setpoint. At most one of ``current``, ``spool`` and
    ``pressure`` is given, the setpoint of the mode of that name.
    """

    position: float | None = None
    """None: not needed by gains alone, nor by an effort in mode force or a mode further in."""
    velocity: float | None = None
    """None: 0, as an effort of None."""
    effort: float | None = None
    """Feed-forward force or torque; the setpoint itself in mode force."""
    stiffness: float | None = None
    """None keeps the gain in force, as does a damping of None."""
    damping: float | None = None
    is_enabled: bool | None = None
    """None leaves the actuator enabled or disabled, as it is."""
    mode: str | None = None
    """current, spool, pressure, force, position or impedance; None keeps the mode."""
    current: float | None = None
    """Of the amplifier, A."""
    spool: float | None = None
    """m."""
    pressure: float | None = None
    """Of chamber A less that of B, Pa."""
    clear_fault: bool = False
    quick_stop: bool = False


_NUMBERS = ('position', 'velocity', 'effort', *GAINS_OF_COMMAND)


class Setpoints(NamedTuple):
    """
    The commands to n actuators at once, numbers or arrays (n,); meaning and units as `Setpoint`.

    A tenth of the time of a mapping from names to `Setpoint`.
    """

    names: Sequence[str]
    position: ArrayLike
    velocity: ArrayLike = 0.0
    effort: ArrayLike = 0.0
    stiffness: ArrayLike | None = None
    """None keeps the gains in force, as does a damping of None."""
    damping: ArrayLike | None = None

    def of(self, k: int) -> Setpoint:
        """Return the setpoint of the k-th actuator."""
        def own(values: ArrayLike | None) -> float | None:
            if values is None:
                return None
            return float(np.broadcast_to(values, len(self.names))[k])
        return Setpoint(own(self.position), own(self.velocity), own(self.effort),
                        own(self.stiffness), own(self.damping))


class Controller:
    """Base of a user's controller; override `step`, and the other methods as needed."""

    @classmethod
    def of(cls, run: Any, values: Mapping[str, Any], where: str) -> 'Controller':
        """
        Return the controller of a section ``{class: module:Class, ...}`` of a run file.

        ``values`` are its other keys, by default the arguments of the class; ``run`` is the
        `isa_ros.config.runs.run_config.RunConfig`, ``where`` file and key for messages.

        Raises
        ------
        ConfigError
            A value is refused.

        """
        try:
            signature(cls).bind(**values)
        except TypeError as error:
            raise ConfigError(f'{where}: {cls.__name__} {error}') from error
        return cls(**values)

    def start(self, names: Sequence[str]) -> None:
        """Begin anew at t = 0 with actuators of these names, in the order of the run."""

    def step(self, state: State) -> Mapping[str, Setpoint] | Setpoints:
        """
        Return the setpoints that take effect one tick after ``state``, by actuator.

        An actuator that is left out keeps its setpoint. The result must depend only on the
        states since `start`, otherwise the run cannot be repeated.
        """
        raise NotImplementedError

    def snapshot(self) -> bytes:
        """Return the whole state of the controller; needed only for saving a run."""
        raise RunError(f'{type(self).__name__} has no snapshot(), so the run cannot be saved')

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`."""
        raise RunError(f'{type(self).__name__} has no restore(), so the run cannot continue')


def fill_requests(
        setpoints: Mapping[str, Setpoint] | Setpoints, names: Sequence[str],
        requests: NDArray[np.void], samples: Mapping[str, np.record] | None = None) -> None:
    """
    Write setpoints into the `COMMAND` rows of the actuators ``names``, shape (n_actuators,).

    The position of a setpoint whose mode does not use it becomes that of ``samples``, by actuator;
    None: it stays NaN.

    Raises
    ------
    SetpointError
        An actuator that the run does not have, or an invalid value.

    """
    if isinstance(setpoints, Setpoints):
        _fill_rows(setpoints, names, requests)
        return
    if not isinstance(setpoints, Mapping):
        raise SetpointError(f'{_quoted(setpoints)} are no setpoints by actuator')
    for name, setpoint in setpoints.items():
        if name not in names:
            raise SetpointError(
                f'{_quoted(name)} is not an actuator of the run; valid: {listed(names)}')
        if not isinstance(setpoint, tuple) or len(setpoint) != len(Setpoint._fields):
            raise SetpointError(f'{name}: {_quoted(setpoint)} is not a Setpoint')
        row = requests[names.index(name)]
        own = Setpoint(*setpoint)
        fill_command(name, own, row)
        if samples is not None:
            if own.effort is None:
                refuse_without_effort(name, own, int(samples[name].device_mode))
            if math.isnan(row['position']):
                _complete(name, samples[name], row)


def _fill_rows(
        setpoints: Setpoints, names: Sequence[str], requests: NDArray[np.void]) -> None:
    """Write setpoints of several actuators into their `COMMAND` rows; as `fill_requests`."""
    try:
        rows = [names.index(name) for name in setpoints.names]
        values = np.full((len(_NUMBERS), len(rows)), math.nan)
        for k, field in enumerate(_NUMBERS):
            given = getattr(setpoints, field)
            if given is not None:
                values[k] = given
                if not (np.isfinite(values[k]).all()
                        and (field not in GAINS_OF_COMMAND or values[k].min() >= 0.0)):
                    raise ValueError
    except (TypeError, ValueError):
        _refuse_rows(setpoints, names)
        raise
    for k, field in enumerate(_NUMBERS):
        requests[field][rows] = values[k]
    requests['kinds'][rows] = HAS_SETPOINT


def _refuse_rows(setpoints: Setpoints, names: Sequence[str]) -> None:
    """Refuse the first of several setpoints that is invalid."""
    fields = setpoints._asdict()
    for field in _NUMBERS:
        given = fields[field]
        try:
            if given is not None:
                np.broadcast_to(np.asarray(given, np.float64), len(setpoints.names))
        except (TypeError, ValueError):
            raise SetpointError(
                f'setpoint {field} = {_quoted(given)}, must be a number or '
                f'{len(setpoints.names)} numbers') from None
    row = np.zeros(len(names), COMMAND)
    fill_requests({name: setpoints.of(k) for k, name in enumerate(setpoints.names)}, names, row)


def _complete(name: str, sample: np.record, row: np.void) -> None:
    """Fill the position of a `COMMAND` row without one; refuse it where the mode uses it."""
    mode = int(row['mode'] if row['kinds'] & HAS_MODE else sample.device_mode)
    if mode in (POSITION, IMPEDANCE):
        raise SetpointError(
            f'{name}: setpoint effort = {row["effort"]:g} needs its position in mode '
            f'{MODES[mode]}')
    row['position'] = sample.position


def refuse_without_effort(name: str, setpoint: Setpoint, mode: int) -> None:
    """
    Refuse a setpoint without the effort that its mode uses; ``mode`` is that in force.

    Raises
    ------
    SetpointError
        It has a position, and neither an effort nor the reference of its mode.

    """
    own = MODES.index(setpoint.mode) if setpoint.mode in MODES[1:] else mode
    if (setpoint.position is not None and setpoint.effort is None
            and own not in (0, POSITION, IMPEDANCE)
            and all(getattr(setpoint, field) is None for field in REFERENCES)):
        needed = 'effort' if own == FORCE else f'{MODES[own]}, or an effort,'
        raise SetpointError(
            f'{name}: setpoint position = {setpoint.position:g} needs its {needed} in mode '
            f'{MODES[own]}, which does not use the position')


def fill_command(name: str, setpoint: Setpoint, row: np.void) -> None:
    """
    Write the command of actuator ``name`` into its `COMMAND` row.

    Raises
    ------
    SetpointError
        A value is invalid, or does not go with the others.

    """
    kinds = _fill_setpoint(name, setpoint, row) | _fill_mode(name, setpoint, row)
    refuse_without_effort(name, setpoint, 0)
    for field in ('is_enabled', 'clear_fault', 'quick_stop'):
        value = getattr(setpoint, field)
        if value is not None and not isinstance(value, (bool, np.bool_)):
            raise _refusal(name, field, value, 'True or False')
    if setpoint.is_enabled is not None:
        kinds |= HAS_ENABLE
        row['is_enabled'] = bool(setpoint.is_enabled)
    row['kinds'] = (kinds | (HAS_CLEAR_FAULT if setpoint.clear_fault else 0)
                    | (HAS_QUICK_STOP if setpoint.quick_stop else 0))


def _fill_setpoint(name: str, setpoint: Setpoint, row: np.void) -> int:
    """
    Write the numbers of a setpoint; return its kind, or 0 without one.

    Without a position that of an effort is NaN, which the mode in force may allow.
    """
    given = [field for field in _NUMBERS if getattr(setpoint, field) is not None]
    for field in _NUMBERS:
        row[field] = math.nan if field in GAINS_OF_COMMAND else 0.0
    for field in given:
        _check(name, field, getattr(setpoint, field))
        row[field] = getattr(setpoint, field)
    if not given:
        return 0
    if set(given) <= set(GAINS_OF_COMMAND):
        return HAS_GAINS
    if setpoint.position is None:
        if setpoint.effort is None:
            raise SetpointError(
                f'{name}: setpoint velocity = {setpoint.velocity:g} needs its position')
        row['position'] = math.nan
    return HAS_SETPOINT


def _fill_mode(name: str, setpoint: Setpoint, row: np.void) -> int:
    """Write mode and reference; return their kinds."""
    kinds = 0
    if setpoint.mode is not None:
        if setpoint.mode not in MODES[1:]:
            raise _refusal(name, 'mode', setpoint.mode, f'one of {listed(MODES[1:])}')
        row['mode'] = MODES.index(setpoint.mode)
        kinds = HAS_MODE
    given = [field for field in REFERENCES if getattr(setpoint, field) is not None]
    if len(given) > 1:
        raise SetpointError(
            f'{name}: setpoint has {" and ".join(given)}, must be the one of its mode')
    for field in given:
        _check(name, field, getattr(setpoint, field))
        if kinds and row['mode'] != REFERENCES[field]:
            raise SetpointError(f'{name}: setpoint {field} is not of mode {setpoint.mode}')
        row['mode'], row['reference'] = REFERENCES[field], getattr(setpoint, field)
        kinds |= HAS_REFERENCE
    return kinds


def _check(name: str, field: str, value: Any) -> None:
    try:
        is_valid = math.isfinite(value) and (value >= 0.0 or field not in GAINS_OF_COMMAND)
    except (TypeError, OverflowError):
        raise _refusal(name, field, value, 'a number') from None
    if not is_valid:
        raise _refusal(name, field, value, '>= 0' if math.isfinite(value) else 'finite')


def _refusal(name: str, field: str, value: Any, bound: str) -> SetpointError:
    return SetpointError(f'{name}: setpoint {field} = {_quoted(value)}, must be {bound}')


def _quoted(value: Any) -> str:
    return shortened(repr(value))


def merge_requests(requests: NDArray[np.void], into: NDArray[np.void]) -> None:
    """Overwrite rows of ``into`` with those `COMMAND` rows of a controller that hold a command."""
    for row, kinds in enumerate(requests['kinds'].tolist()):
        if kinds:
            into[row] = requests[row]


def only_rows(rows: Mapping[str, NDArray[np.void]]) -> dict[str, np.record]:
    """Return the only row of each array, (1,), with its fields as attributes, by name."""
    return {name: own.view(np.recarray)[0] for name, own in rows.items()}


def only_of(records: Mapping[str, np.record]) -> np.record | None:
    """Return the only record; None without one, or with several."""
    return next(iter(records.values())) if len(records) == 1 else None


def by_name(names: Sequence[str], rows: NDArray[np.void]) -> dict[str, np.record]:
    """Return rows with their fields as attributes, on the same memory, by name."""
    return dict(zip(names, rows.view(np.recarray)))
