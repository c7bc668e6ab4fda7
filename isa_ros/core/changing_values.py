"""
Named values that change between two ticks: accepted, in force from the next tick, echoed.

A fault lies over a value: while it does, a value that is accepted stays beneath it and comes back
with its end. `OVER` before a name puts a value over it, `OFF` takes it off; `RECORDED` puts over
it what a bag has as in force, which is so at once.
"""

from collections.abc import Mapping, Sequence

from isa_ros.core.saved_numbers import SavedNumbers
import numpy as np

OVER, OFF, RECORDED = '+', '-', '='
_BEFORE, _IN_FORCE, _ACCEPTED, _OVER, _IS_OVER = range(5)
_AS_RECORDED = 2.0


def bare(name: str) -> str:
    """Return a name without `OVER`, `OFF` or `RECORDED`."""
    return name[1:] if name[:1] in (OVER, OFF, RECORDED) else name


class ChangingValues(SavedNumbers):
    """
    Values in force before the last tick, in force now, and in force from the next tick on.

    ``names`` have the values ``first`` at t = 0; ``owner`` is named in errors. The values are
    checked by whoever accepts them.
    """

    def __init__(self, owner: str, names: Sequence[str], first: Sequence[float]) -> None:
        self._first = np.array(first, float)
        super().__init__(owner, names, np.tile(self._first, (5, 1)))
        self._place = {name: k for k, name in enumerate(names)}
        self._rows[_IS_OVER] = 0.0
        self.is_settled = True
        """Whether no value changed at the start of the last tick, or changes at the next."""

    def restart(self) -> dict[str, float]:
        """
        Put the first values in force until the next tick; return what is accepted for it.

        What lies over values is taken off.
        """
        self._rows[_BEFORE] = self._rows[_IN_FORCE] = self._first
        self._rows[_IS_OVER] = 0.0
        self.is_settled = False
        return self.accepted

    def accept(self, values: Mapping[str, float]) -> None:
        """
        Accept new values of known names, which may begin with `OVER`, `OFF` or `RECORDED`.

        The last of several before one tick wins.
        """
        for name, value in values.items():
            k = self._place[bare(name)]
            if name[:1] in (OVER, RECORDED):
                self._rows[_OVER, k] = value
                self._rows[_IS_OVER, k] = _AS_RECORDED if name[:1] == RECORDED else 1.0
            elif name[:1] == OFF:
                self._rows[_IS_OVER, k] = 0.0
            else:
                self._rows[_ACCEPTED, k] = value
        self.is_settled = False

    def with_accepted(self, values: Mapping[str, float]) -> tuple[dict[str, float], ...]:
        """
        Return all values that are not the first ones, as they would be after `accept`.

        Those of the next tick, and those beneath, which come back when nothing lies over them.
        """
        rows = self._rows.copy()
        try:
            self.accept(values)
            return self.accepted, self._where(
                _ACCEPTED, self._rows[_ACCEPTED] != self._first)
        finally:
            self._rows[:] = rows

    def value(self, name: str) -> float:
        """Return the value of the next tick."""
        return float(self.wanted[self._place[name]])

    @property
    def wanted(self) -> np.ndarray:
        """Return the values of the next tick, (n,), in the order of the names."""
        values: np.ndarray = np.where(
            self._rows[_IS_OVER] != 0.0, self._rows[_OVER], self._rows[_ACCEPTED])
        return values

    @property
    def now(self) -> np.ndarray:
        """Return the values in force, (n,)."""
        values: np.ndarray = self._rows[_IN_FORCE].copy()
        return values

    @property
    def recorded(self) -> np.ndarray:
        """Return which values are in force as a bag has them, (n,)."""
        found: np.ndarray = self._rows[_IS_OVER] == _AS_RECORDED
        return found

    def withdraw(self, which: np.ndarray, values: np.ndarray) -> None:
        """Take back what was accepted of ``which``, (n,): their ``values``, (m,), stay."""
        differs = self.wanted[which] != values
        late = np.flatnonzero(which)[differs]
        self._rows[_ACCEPTED, late] = values[differs]
        self._rows[_IS_OVER, late] = 0.0

    def latch(self, values: np.ndarray | None = None) -> bool:
        """
        Begin a tick: put the accepted values in force; return whether any has changed.

        ``values``, (n,): those instead, where some are on their way.
        """
        if self.is_settled:
            return False
        before, in_force = self._rows[:_ACCEPTED]
        before[:] = in_force
        in_force[:] = self.wanted if values is None else values
        self.is_settled = bool((before == in_force).all())
        return not self.is_settled

    def change(self, name: str) -> tuple[float, float]:
        """Return the value in force before the last tick, and the one in force now."""
        k = self._place[name]
        return float(self._rows[_BEFORE, k]), float(self._rows[_IN_FORCE, k])

    @property
    def accepted(self) -> dict[str, float]:
        """Return the values of the next tick that are not the first ones."""
        values = self.wanted
        return {self.names[k]: float(values[k])
                for k in np.flatnonzero(values != self._first)}

    @property
    def in_force(self) -> dict[str, float]:
        """Return the values in force that are not the first ones."""
        return self._where(_IN_FORCE, self._rows[_IN_FORCE] != self._first)

    @property
    def applied(self) -> dict[str, float]:
        """Return the changes at the start of the last tick."""
        if self.is_settled:
            return {}
        return self._where(_IN_FORCE, self._rows[_BEFORE] != self._rows[_IN_FORCE])

    def _where(self, row: int, differs: np.ndarray) -> dict[str, float]:
        values = self._rows[row]
        return {self.names[k]: float(values[k]) for k in np.flatnonzero(differs)}

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`; as `SavedNumbers.restore`."""
        super().restore(snapshot)
        self.is_settled = False
