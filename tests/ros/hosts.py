"""
Hosts on this machine: network namespaces, joined by a cable or by a lossy relay.

Made inside a user namespace, so that root is not needed if the kernel allows that.
"""

from collections.abc import Iterator
from contextlib import contextmanager, ExitStack
from dataclasses import dataclass
from pathlib import Path
import re
import shutil
import signal
import subprocess

from tests.ros.relay import READY
from tests.ros.started import Started, started, wait_for

INTERFACE = 'eth0'
ADDRESSES = '192.0.2.1', '192.0.2.2'  # RFC 5737: reserved for documentation
PREFIX_BITS = 24
_DOWN = re.compile('state (LOWERLAYER)?DOWN')


@dataclass(frozen=True)
class Host:
    """A network namespace, held by a process."""

    holder: int
    address: str = ''

    @property
    def enter(self) -> list[str]:
        """Return the command that becomes another one in this namespace."""
        return ['nsenter', f'--target={self.holder}', '--user', '--preserve-credentials',
                '--net', '--']

    def run(self, *command: str) -> None:
        """Run a command to its end."""
        subprocess.run([*self.enter, *command], check=True, capture_output=True)

    def plug(self, name: str, other: 'Host', other_name: str) -> None:
        """Connect this host to another by a cable."""
        self.run('ip', 'link', 'add', name, 'type', 'veth',
                 'peer', 'name', other_name, 'netns', str(other.holder))

    def set_up(self, interface: str) -> None:
        """Switch an interface on, and the loopback interface; give it the address, if any."""
        if self.address:
            self.run('ip', 'address', 'add', f'{self.address}/{PREFIX_BITS}', 'dev', interface)
        self.run('ip', 'link', 'set', 'lo', 'up')
        self.run('ip', 'link', 'set', interface, 'up')

    def wait_for_cable(self) -> None:
        """
        Wait until the system has found the other end, which may take a second.

        DDS does not use an interface that is not running when a participant begins.
        """
        wait_for(lambda: not _DOWN.search(self._shown()), f'the cable of {self.address}')

    def _shown(self) -> str:
        return subprocess.run([*self.enter, 'ip', 'link', 'show', INTERFACE], check=True,
                              capture_output=True, text=True).stdout


def why_no_hosts() -> str | None:
    """Return why this machine cannot create hosts; None: it can."""
    for tool in ('ip', 'nsenter', 'unshare'):
        if shutil.which(tool) is None:
            return f'the command {tool} is missing'
    tried = subprocess.run(
        ['unshare', '--user', '--map-root-user', '--net',
         'ip', 'link', 'add', INTERFACE, 'type', 'veth'], capture_output=True, text=True)
    return tried.stderr.strip() if tried.returncode else None


@contextmanager
def two_hosts() -> Iterator[tuple[Host, Host]]:
    """Yield two hosts with a cable between them."""
    with ExitStack() as stack:
        first, second = _addressed(stack)
        first.plug(INTERFACE, second, INTERFACE)
        first.set_up(INTERFACE)
        second.set_up(INTERFACE)
        first.wait_for_cable()
        second.wait_for_cable()
        yield first, second


class Relay:
    """The relay between two hosts."""

    def __init__(self, process: Started) -> None:
        self._process = process

    def end(self) -> tuple[int, int]:
        """End it and return how many frames it has forwarded and dropped."""
        self._process.signal(signal.SIGTERM)
        assert self._process.exit_code() == 0, self._process.errors
        found = re.search(r'forwarded (\d+), dropped (\d+)', self._process.errors)
        assert found is not None
        return int(found[1]), int(found[2])


@contextmanager
def two_lossy_hosts(
        log: Path, loss: float, seed: int) -> Iterator[tuple[Host, Host, Relay]]:
    """Yield two hosts and, between them, a relay that loses a share of all frames."""
    with ExitStack() as stack:
        first, second = _addressed(stack)
        between = Host(_namespace(stack, first.enter))
        for number, host in enumerate((first, second)):
            host.plug(INTERFACE, between, f'port{number}')
            between.set_up(f'port{number}')
            host.set_up(INTERFACE)
            host.wait_for_cable()
        process = stack.enter_context(started(
            log, 'tests.ros.relay', 'port0', 'port1', str(loss), str(seed),
            prefix=between.enter))
        wait_for(lambda: READY in process.errors or not process.is_running(), 'the relay')
        yield first, second, Relay(process)


def _addressed(stack: ExitStack) -> tuple[Host, Host]:
    """Return two hosts of one user namespace without any cable."""
    owner = Host(_namespace(stack, ['unshare', '--user', '--map-root-user']))
    return (Host(owner.holder, ADDRESSES[0]),
            Host(_namespace(stack, owner.enter), ADDRESSES[1]))


def _namespace(stack: ExitStack, prefix: list[str]) -> int:
    """Make a network namespace and return the process that holds it while the stack lasts."""
    holder = subprocess.Popen(
        [*prefix, 'unshare', '--net', 'cat'], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    stack.callback(holder.wait)
    stack.callback(holder.kill)
    assert holder.stdin is not None and holder.stdout is not None
    stack.enter_context(holder.stdout)
    stack.enter_context(holder.stdin)
    holder.stdin.write(b'.')
    holder.stdin.flush()
    assert holder.stdout.read(1) == b'.'  # it answers once it is in the namespace
    return holder.pid
