"""Every peer, and what it needs."""

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Protocol

from isa_ros.bench.peers.link import Link
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError


@dataclass(frozen=True)
class Peer:
    """A middleware; ``package`` is what its file imports, '' where Python has it."""

    name: str
    title: str
    module: str
    package: str

    @property
    def is_installed(self) -> bool:
        """Tell whether its package is there."""
        return not self.package or find_spec(self.package) is not None


PEERS = (
    Peer('pipes', 'multiprocessing pipes', 'multiprocessing_pipes', ''),
    Peer('zeromq', 'ZeroMQ ipc', 'zeromq', 'zmq'),
    Peer('cyclone', 'Cyclone DDS from Python', 'cyclone', 'cyclonedds'),
    Peer('helics', 'HELICS', 'federates', 'helics'),
)


class Ends(Protocol):
    """What the file of a peer has."""

    def coordinator_end(self, directory: Path, n_workers: int) -> Link:
        """Open the coordinator's end; ``directory`` is this run's own."""
        ...

    def worker_end(self, directory: Path, index: int) -> Link:
        """Open the end of one worker; the coordinator's is open."""
        ...


def peer(name: str) -> Peer:
    """
    Return the peer of a name.

    Raises
    ------
    ConfigError
        There is none.

    """
    for one in PEERS:
        if one.name == name:
            return one
    names = [one.name for one in PEERS]
    raise ConfigError(f'no peer {name!r}; {alternatives(name, names)}')


def ends(of: Peer) -> Ends:
    """Return both ends of a peer that is installed."""
    module: Ends = import_module(f'{__package__}.{of.module}')
    return module
