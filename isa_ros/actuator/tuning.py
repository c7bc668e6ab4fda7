"""Tuned values of one actuator: accepted between two ticks, in force from the next one."""

from collections.abc import Mapping

from isa_ros.actuator.inbox import WITH_GAINS
from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.actuator.tunable import GAINS, tunables, tuned
from isa_ros.core.signals import COMMAND, HAS_GAINS
from isa_ros.errors import ConfigError
import numpy as np

_BEFORE, _IN_FORCE, _ACCEPTED = range(3)


class Tuning:
    """
    Keeps the REU part of an `ACTUATOR` row up to date; the states of the loops are unchanged.

    ``constants`` is that row, shape (1,), made from ``sheet`` with ``offset_steps``; ``name`` is
    the actuator's. Values of `GAINS` take effect with the setpoints and are only stored here.
    """

    def __init__(
            self, name: str, sheet: ActuatorSheet, offset_steps: int,
            constants: np.ndarray) -> None:
        self._name = name
        self._sheet = sheet
        self._offset_steps = offset_steps
        self._constants = constants
        self._written = constants['reu'].copy()
        found = tunables(sheet)
        self._names = list(found)
        self._first = np.array([tunable.value for tunable in found.values()], float)
        # Values in force before the last tick, in force now, and in force from the next tick on.
        self._rows = np.tile(self._first, (3, 1))
        self._is_settled = True

    def reset(self) -> dict[str, float]:
        """Restore the sheet's values until the next tick; return the `GAINS` accepted for it."""
        self._rows[_BEFORE] = self._rows[_IN_FORCE] = self._first
        self._is_settled = False
        self._constants['reu'] = self._written
        return {name: value for name, value in self._changed(_ACCEPTED).items() if name in GAINS}

    def accept(self, values: Mapping[str, float]) -> None:
        """
        Accept new values, SI, all or none; the last of several before one tick wins.

        Raises
        ------
        ConfigError
            As `isa_ros.actuator.tunable.tuned`.

        """
        self._tuned_by(self._changed(_ACCEPTED) | dict(values))
        for name, value in values.items():
            self._rows[_ACCEPTED, self._names.index(name)] = value
        self._is_settled = False

    def value(self, name: str) -> float:
        """Return the last accepted value."""
        return float(self._rows[_ACCEPTED, self._names.index(name)])

    def latch(self) -> bool:
        """Begin a tick: put the accepted values in force; return whether one of a loop changed."""
        if self._is_settled:
            return False
        before, in_force, accepted = self._rows
        before[:] = in_force
        in_force[:] = accepted
        self._is_settled = bool((before == in_force).all())
        if not self._is_settled:
            self._write()
        return bool(self.applied)

    def _tuned_by(self, values: Mapping[str, float]) -> ActuatorSheet:
        try:
            return tuned(self._sheet, values)
        except ConfigError as error:
            raise ConfigError(f'{self._name}: {error}') from error

    def _write(self) -> None:
        changed = self._changed(_IN_FORCE)
        self._constants['reu'] = actuator_record(
            self._tuned_by(changed), self._offset_steps)['reu'] if changed else self._written

    def _changed(self, row: int) -> dict[str, float]:
        """Return the values of a row that differ from the sheet."""
        return self._where(row, self._rows[row] != self._first)

    def _where(self, row: int, differs: np.ndarray) -> dict[str, float]:
        values = self._rows[row]
        return {self._names[k]: float(values[k]) for k in np.flatnonzero(differs)}

    @property
    def applied(self) -> dict[str, float]:
        """Return the changes at the start of the last tick without `GAINS`, outermost first."""
        if self._is_settled:
            return {}
        changed = self._where(_IN_FORCE, self._rows[_BEFORE] != self._rows[_IN_FORCE])
        return {name: value for name, value in changed.items() if name not in GAINS}

    @property
    def nbytes(self) -> int:
        """Return the size of a `snapshot`."""
        return self._rows.nbytes

    def snapshot(self) -> bytes:
        """Return the state as bytes for `restore`."""
        return self._rows.tobytes()

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`; raises as `accept`, also for a value that is not finite."""
        rows = np.frombuffer(snapshot).reshape(self._rows.shape)
        for row, k in np.argwhere(~np.isfinite(rows)):
            raise ConfigError(
                f'{self._name}: saved state has {self._names[k]} = {rows[row, k]}, must be finite')
        self._rows[:] = rows
        self._tuned_by(self._changed(_ACCEPTED))
        self._is_settled = False
        self._write()


def gains_command(values: Mapping[str, float]) -> np.void:
    """Return the `COMMAND` row of the `GAINS` among tuned values; without any, kinds is 0."""
    command: np.void = np.zeros(1, COMMAND)[0]
    command['kinds'] = 0 if GAINS.keys().isdisjoint(values) else HAS_GAINS
    for name, gain in GAINS.items():
        command[gain] = values.get(name, np.nan)
    return command


def gain_after(name: str, pending: np.record, reu: np.record) -> float:
    """Return a gain of `GAINS` after the ``pending`` command has taken effect."""
    gain = GAINS[name]
    is_new = int(pending.kinds) & WITH_GAINS and not np.isnan(pending[gain])
    return float((pending if is_new else reu.setpoint)[gain])
