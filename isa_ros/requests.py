"""Requests of controllers, programs and nodes: setpoints become rows, or are refused."""

from collections.abc import Iterable, Mapping, Sequence
import math
from typing import Any

from isa_ros.controller import Setpoint, Setpoints
from isa_ros.core.device import FORCE, IMPEDANCE, MODES, POSITION, REFERENCES
from isa_ros.core.record import floats
from isa_ros.core.signals import (
    COMMAND, GAINS_OF_COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_QUICK_STOP,
    HAS_REFERENCE, HAS_SETPOINT)
from isa_ros.core.suggest import listed, shortened
from isa_ros.errors import SetpointError
import numpy as np
from numpy.typing import NDArray

_NUMBERS = ('position', 'velocity', 'effort', *GAINS_OF_COMMAND)
_ZERO_IF_NONE = slice(1, 3)     # of these: velocity and effort
_OUTER = (0, POSITION, IMPEDANCE)
"""No mode yet, and the modes that follow a position; those further in use the effort."""
_COLUMNS = slice(1, 1 + len(_NUMBERS))     # of a `COMMAND`: behind the word of its two flags
_GAINS = slice(-len(GAINS_OF_COMMAND), None)


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
        if setpoints.position is not None:
            _fill_rows(setpoints, names, requests, samples)
            return
        setpoints = _by_name(setpoints)
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
        setpoints: Setpoints, names: Sequence[str], requests: NDArray[np.void],
        samples: Mapping[str, np.record] | None) -> None:
    """Write setpoints of several positions into their `COMMAND` rows; as `fill_requests`."""
    try:
        rows = [names.index(name) for name in setpoints.names]
        values = np.full((len(_NUMBERS), len(rows)), math.nan)
        values[_ZERO_IF_NONE] = 0.0
        given = [k for k, field in enumerate(_NUMBERS) if getattr(setpoints, field) is not None]
        for k in given:
            values[k] = getattr(setpoints, _NUMBERS[k])
        if not np.isfinite(values[given]).all() or (values[_GAINS] < 0.0).any():
            raise ValueError
        if setpoints.effort is None and samples is not None and any(
                samples[names[row]].device_mode not in _OUTER for row in rows):
            raise ValueError
    except (TypeError, ValueError):
        fill_requests(_by_name(setpoints), names, np.zeros(len(names), COMMAND), samples)
        raise
    floats(requests)[rows, _COLUMNS] = values.T
    requests['kinds'][rows] = HAS_SETPOINT


def _by_name(setpoints: Setpoints) -> dict[str, Setpoint]:
    """Return setpoints of several actuators as one of each; raises `SetpointError`."""
    names = setpoints.names
    if not isinstance(names, Iterable) or not all(isinstance(name, str) for name in names):
        raise SetpointError(f'{_quoted(names)} are no names of actuators')
    for field in _NUMBERS:
        given = getattr(setpoints, field)
        try:
            if given is not None:
                np.broadcast_to(np.asarray(given, np.float64), len(names))
        except (TypeError, ValueError):
            raise SetpointError(
                f'setpoint {field} = {_quoted(given)}, must be a number or '
                f'{len(names)} numbers') from None
    return {name: setpoints.of(k) for k, name in enumerate(names)}


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
            and own not in _OUTER
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
    return shortened(repr(value.item() if isinstance(value, np.generic) else value))


def merge_requests(requests: NDArray[np.void], into: NDArray[np.void]) -> None:
    """Overwrite rows of ``into`` with those `COMMAND` rows of a controller that hold a command."""
    for row, kinds in enumerate(requests['kinds'].tolist()):
        if kinds:
            into[row] = requests[row]
