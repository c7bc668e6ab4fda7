"""Limits of this process and size of this host: cores, memory, priority, locked and shared."""

from collections.abc import Iterator
import os
from pathlib import Path
import resource

from isa_ros.cli.doctor.finding import Finding, Verdict

SHARED = Path('/dev/shm')
BYTES_OF_A_MEGABYTE = 1_000_000

_GROUP = 'host'


def limits() -> Iterator[Finding]:
    """Yield what this process may use."""
    cores = len(os.sched_getaffinity(0))
    yield Finding(_GROUP, 'cores', f'{cores}, load {os.getloadavg()[0]:.1f}') if cores > 1 else (
        Finding(_GROUP, 'cores', '1', Verdict.NOTE,
                'nodes in processes of their own share it: bringup --in-process is faster'))
    size = os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES')
    yield Finding(_GROUP, 'memory', in_megabytes(size))
    yield Finding(_GROUP, 'open files', limit_text(resource.RLIMIT_NOFILE))
    yield Finding(_GROUP, 'memlock', f'{limit_text(resource.RLIMIT_MEMLOCK)} bytes (isa_ros locks '
                                     'none, masters of a bus may)')
    yield priority(may_run_in_real_time(), limit_text(resource.RLIMIT_RTPRIO))
    yield shared(SHARED)


def in_megabytes(size: int) -> str:
    """Return a number of bytes for people."""
    return f'{size / BYTES_OF_A_MEGABYTE:.0f} MB'


def limit_text(kind: int) -> str:
    """Return a limit of this process, as the shell's ulimit has it."""
    limit, _ = resource.getrlimit(kind)
    return 'unlimited' if limit == resource.RLIM_INFINITY else str(limit)


def priority(is_allowed: bool, limit: str) -> Finding:
    """Return whether a bus may run under SCHED_FIFO, and the limit rtprio."""
    if is_allowed:
        return Finding(_GROUP, 'rtprio', f'SCHED_FIFO is allowed, limit {limit}')
    return Finding(
        _GROUP, 'rtprio', f'SCHED_FIFO is refused, limit {limit}', Verdict.NOTE,
        'isa bus --pace real_time is later without: CAP_SYS_NICE, or rtprio in '
        '/etc/security/limits.conf')


def may_run_in_real_time() -> bool:
    """Return whether the system gives SCHED_FIFO; this process keeps its own policy."""
    before, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        return False
    os.sched_setscheduler(0, before, parameters)
    return True


def shared(directory: Path) -> Finding:
    """Return the size of the shared memory, which only other middleware profiles use."""
    if not os.access(directory, os.W_OK | os.X_OK):
        return Finding(
            _GROUP, 'shared memory', f'{directory} is not writable', Verdict.NOTE,
            'the middleware profile of isa_ros uses none, others do (docs/network.md)')
    found = os.statvfs(directory)
    return Finding(
        _GROUP, 'shared memory',
        f'{in_megabytes(found.f_frsize * found.f_blocks)} in {directory} (isa_ros uses none)')
