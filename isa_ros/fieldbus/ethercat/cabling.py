"""
The cables of a line of slaves: how far the frames of the master get.

Each slave has two ports, 0 towards the master and 1 away from it. A slave without power, or whose
cable towards the master is pulled, is not reached, and neither are those behind it: the slave
before it closes the loop of its port 1, and the frames return from there.
"""


class Cabling:
    """Which of ``n_slaves`` have power, and which cables towards the master are in."""

    def __init__(self, n_slaves: int) -> None:
        self._is_pulled = [False] * n_slaves
        self.is_powered = [True] * n_slaves
        """By position."""

    def pull(self, position: int, is_pulled: bool) -> None:
        """Pull the cable between a slave and the one before it or the master, or put it back."""
        self._is_pulled[position] = is_pulled

    @property
    def links(self) -> list[bool]:
        """Return whether each slave is linked towards the master; behind the last is no link."""
        powered = [True, *self.is_powered]
        return [*(before and own and not pulled for before, own, pulled in zip(
            powered, self.is_powered, self._is_pulled)), False]

    @property
    def n_reached(self) -> int:
        """Return how many slaves the frames reach."""
        return self.links.index(False)
