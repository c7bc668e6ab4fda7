"""Rows of numbers that are a state: their bytes in a snapshot, and back."""

from collections.abc import Sequence

from isa_ros.errors import ConfigError
import numpy as np


class SavedNumbers:
    """
    Rows of numbers, of which each column has one of ``names``; ``owner`` is named in errors.

    The numbers are finite: what a snapshot has is refused otherwise.
    """

    def __init__(self, owner: str, names: Sequence[str], rows: np.ndarray) -> None:
        self.owner, self.names = owner, list(names)
        self._rows = rows

    @property
    def nbytes(self) -> int:
        """Return the size of a `snapshot`."""
        return self._rows.nbytes

    def snapshot(self) -> bytes:
        """Return the state as bytes for `restore`."""
        return self._rows.tobytes()

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot`.

        Raises
        ------
        ConfigError
            A number is not finite.

        """
        rows = np.frombuffer(snapshot).reshape(self._rows.shape)
        for row, k in np.argwhere(~np.isfinite(rows)):
            raise ConfigError(
                f'{self.owner}: saved state has {self.names[k]} = {rows[row, k]}, must be finite')
        self._rows[:] = rows
