"""The rows of an actuator's memory that are its state, as the bytes of a snapshot."""

from collections.abc import Sequence

from isa_ros.actuator.link import refuse_states
from isa_ros.actuator.rows import Memory
from isa_ros.actuator.saved_ranges import refuse_beyond
from isa_ros.core.saved_state import broken_number, restored_rows
from isa_ros.core.signals import Records
from isa_ros.errors import SimulationDiverged

_SAVED = ('body', 'reu', 'channels', 'port', 'pending', 'applied', 'reply', 'sample', 'thermal',
          'plays')
"""The rows of a snapshot, in their order."""
_SAVED_OF_LINK = ('links', 'sent', 'outbox', 'commands_sent', 'samples_sent', 'observed')
"""Those of an actuator with a link, behind the others."""


class SavedRows:
    """
    The state of one actuator: views on the rows of its memory.

    ``owner`` is the name of the actuator, for errors; without a link what listeners have is no
    state of its own, but the sample.
    """

    def __init__(self, owner: str, memory: Memory, has_link: bool) -> None:
        self._owner, self._memory, self._has_link = owner, memory, has_link
        self._names: tuple[str, ...] = _SAVED
        self._rows: list[Records] = [
            memory.continuous[:1], memory.reu, memory.channels, memory.ports, memory.pending,
            memory.applied, memory.replies, memory.samples, memory.thermals, memory.plays]
        if has_link:
            self._names += _SAVED_OF_LINK
            self._rows += [getattr(memory, name) for name in _SAVED_OF_LINK]
        self.nbytes = sum(rows.nbytes for rows in self._rows)
        """Size of a snapshot."""

    @property
    def rows(self) -> Sequence[tuple[str, Records]]:
        """Return name and rows of each part, as they follow each other in a snapshot."""
        return list(zip(self._names, self._rows))

    def clear(self) -> None:
        """Set the whole state to zero."""
        for rows in self._rows:
            rows.fill(0)

    def snapshot(self, t_ns: int) -> bytes:
        """
        Return the state as bytes; ``t_ns`` is its time.

        Raises
        ------
        SimulationDiverged
            A number of the state is not finite.

        """
        for name, rows in self.rows:
            broken = broken_number(rows)
            if broken is not None:
                raise SimulationDiverged(t_ns, f'{self._owner}.{name}: {broken[0]}', broken[1])
        return b''.join(rows.tobytes() for rows in self._rows)

    def read(self, snapshot: bytes, offset: int) -> Sequence[Records]:
        """
        Return the rows of a snapshot that begins at a byte, for `restore`.

        Raises
        ------
        ConfigError
            A number in it is not finite or beyond its range.

        """
        found = []
        for name, rows in self.rows:
            found.append(restored_rows(
                snapshot, rows.dtype, len(rows), offset, f'{self._owner}.{name}'))
            offset += rows.nbytes
        refuse_beyond(self._owner, zip(self._names, found))
        if self._has_link:
            refuse_states(found[len(_SAVED)], self._owner)
        return found

    def restore(self, found: Sequence[Records]) -> None:
        """Continue from the rows that `read` returned."""
        for rows, restored in zip(self._rows, found):
            rows[:] = restored
        if not self._has_link:
            self._memory.observed[:] = self._memory.samples
