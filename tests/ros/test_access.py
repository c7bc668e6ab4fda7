"""Access from outside: by default from this host only, and no shared memory is left behind."""

from collections.abc import Iterator
import ipaddress
import os
from pathlib import Path

import pytest
from tests.ros.started import actuator, rig_until_stopped, started, wait_for

pytestmark = pytest.mark.ros
DISCOVERY = (
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
    'FASTDDS_BUILTIN_TRANSPORTS', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_LOCALHOST_ONLY',
    'ROS_STATIC_PEERS')
INODE_COLUMN, LOCAL_COLUMN = 9, 1  # of /proc/net/udp and similar files, see proc_net_tcp.txt


@pytest.fixture(autouse=True)
def untouched(monkeypatch):
    """Remove all settings that a user may have."""
    for name in DISCOVERY:
        monkeypatch.delenv(name, raising=False)


def bound_addresses(pid: int) -> Iterator[str]:
    """Yield the local address of every internet socket of a process."""
    inodes = set()
    for descriptor in Path(f'/proc/{pid}/fd').iterdir():
        try:
            target = os.readlink(descriptor)
        except FileNotFoundError:  # closed since the listing
            continue
        if target.startswith('socket:['):
            inodes.add(target[len('socket:['):-1])
    for protocol in ('udp', 'udp6', 'tcp', 'tcp6', 'raw', 'raw6', 'udplite', 'udplite6'):
        table = Path(f'/proc/{pid}/net/{protocol}')
        if not table.exists():
            continue
        for line in table.read_text().splitlines()[1:]:
            columns = line.split()
            if columns[INODE_COLUMN] in inodes:
                yield str(ip_address(columns[LOCAL_COLUMN].split(':')[0]))


def ip_address(digits: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """Return an address that the kernel prints as words of the host's (little) endianness."""
    words = bytes.fromhex(digits)
    return ipaddress.ip_address(
        b''.join(words[k:k + 4][::-1] for k in range(0, len(words), 4)))


def shared_memory(pid: int) -> list[str]:
    """Return the middleware's shared memory that a process has mapped."""
    return [line for line in Path(f'/proc/{pid}/maps').read_text().splitlines()
            if '/dev/shm/fastrtps' in line]


@pytest.mark.parametrize('options, n_processes', [((), 2), (('--in-process',), 1)])
def test_nothing_listens_on_the_network_unasked(domain, tmp_path, options, n_processes):
    """Every socket of every process of a run is bound to the loopback interface."""
    bag = tmp_path / 'bag'
    with rig_until_stopped(bag, *options) as run:
        wait_for(lambda: (bag / 'metadata.yaml').exists() or not run.is_running(), 'tick 0')
        assert run.is_running(), run.errors
        pids = [run.pid, *run.children().values()]
        assert len(pids) == n_processes
        for pid in pids:
            addresses = list(bound_addresses(pid))
            assert len(addresses) >= 2  # discovery and data
            assert set(addresses) == {'127.0.0.1'}
            assert shared_memory(pid) == []  # what SIGKILL would leave behind


def test_a_lone_actuator_listens_on_loopback_only(observer, tmp_path):
    """Once another node sees it, all its sockets are open."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5') as process:
        wait_for(lambda: observer.count_publishers('/knee/joint_states'), 'the actuator')
        addresses = list(bound_addresses(process.pid))
        assert len(addresses) >= 2
        assert set(addresses) == {'127.0.0.1'}


def test_a_user_who_asks_for_the_network_gets_it(domain, tmp_path, monkeypatch):
    """There is no shared memory with these settings either."""
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    with actuator(tmp_path / 'log', 'knee', model='isa_v5') as process:
        wait_for(lambda: '0.0.0.0' in bound_addresses(process.pid), 'a socket on the network')
        assert shared_memory(process.pid) == []


@pytest.mark.parametrize('asked', [None, 'LOCALHOST'])
def test_a_plain_node_of_this_host_reads_and_commands(domain, tmp_path, monkeypatch, asked):
    """The node has ROS's own defaults, or the range of this host only, and no profile."""
    with actuator(tmp_path / 'actuator.log', 'knee', model='isa_v5') as knee:
        if asked is not None:
            monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', asked)
        with started(tmp_path / 'plain.log', 'tests.ros.plain_node', 'knee', '0.03') as plain:
            assert plain.exit_code() == 0, plain.errors
        assert knee.is_running(), knee.errors


def test_security_that_is_not_there_is_refused(domain, tmp_path, monkeypatch):
    """The wheels are built without security; in a build with it, its files are missing here."""
    (tmp_path / 'keystore' / 'enclaves').mkdir(parents=True)
    monkeypatch.setenv('ROS_SECURITY_ENABLE', 'true')
    monkeypatch.setenv('ROS_SECURITY_STRATEGY', 'Enforce')
    monkeypatch.setenv('ROS_SECURITY_KEYSTORE', str(tmp_path / 'keystore'))
    with actuator(tmp_path / 'log', 'knee', model='isa_v5') as process:
        assert process.exit_code() == 2
    assert 'ROS_SECURITY_ENABLE = true requires security' in process.errors
    assert 'Traceback' not in process.errors
