"""All peers, and the packages they need."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Protocol

from benchmarks.peers.peer_end import PeerEnd
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError


@frozen
class Peer:
    """A middleware; ``package`` is the one its file imports, '' for the standard library."""

    name: str
    title: str
    module: str
    package: str

    @property
    def is_installed(self) -> bool:
        """Return whether its package is installed."""
        return not self.package or find_spec(self.package) is not None


PEERS = (
    Peer('pipes', 'multiprocessing pipes', 'multiprocessing_pipes', ''),
    Peer('zeromq', 'ZeroMQ ipc', 'zeromq', 'zmq'),
    Peer('cyclone', 'Cyclone DDS from Python', 'cyclone', 'cyclonedds'),
    Peer('helics', 'HELICS', 'federates', 'helics'),
)


def installed() -> list[Peer]:
    """Return the peers whose packages are installed."""
    return [peer for peer in PEERS if peer.is_installed]


class PeerModule(Protocol):
    """Interface of the file of a peer."""

    def coordinator_end(self, directory: Path, n_workers: int) -> PeerEnd:
        """Open the coordinator's end; only this run uses ``directory``."""
        ...

    def worker_end(self, directory: Path, index: int) -> PeerEnd:
        """Open the end of one worker; that of the coordinator is already open."""
        ...


def peer(name: str) -> Peer:
    """
    Return a peer by its name.

    Raises
    ------
    ConfigError
        The peer does not exist.

    """
    for one in PEERS:
        if one.name == name:
            return one
    names = [one.name for one in PEERS]
    raise ConfigError(f'peer {name!r} is unknown; {alternatives(name, names)}')


def ends(of: Peer) -> PeerModule:
    """Return the functions of an installed peer."""
    module: PeerModule = import_module(f'{__package__}.{of.module}')
    return module
