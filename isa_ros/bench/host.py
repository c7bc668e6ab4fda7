"""Data of the host: its processors, and the memory and processor time of processes."""

from contextlib import suppress
import os
from pathlib import Path
import platform

from isa_ros.bench.spec import ProcessMemory
from isa_ros.core.frozen import frozen

_PROC = Path('/proc')
_KIB = 1024
_USER_TIME, _SYSTEM_TIME = 11, 12   # in /proc/PID/stat after the name and the state


@frozen
class Machine:
    """Description of the machine for a page of measurements."""

    processor: str
    cores: int
    memory_gib: float
    kernel: str
    python: str
    load: float
    """Load average of the minute before the bench."""

    @property
    def summary(self) -> str:
        """Return the description in one line."""
        return (f'{self.processor}, {self.cores} cores, {self.memory_gib:.0f} GiB, Linux '
                f'{self.kernel}, Python {self.python}, load {self.load:.1f} before')


def machine() -> Machine:
    """Return the description of this machine."""
    pages = os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE')
    return Machine(
        processor=_processor(), cores=len(os.sched_getaffinity(0)),
        memory_gib=pages / _KIB ** 3, kernel='.'.join(platform.release().split('.')[:2]),
        python=platform.python_version(), load=os.getloadavg()[0])


def _processor() -> str:
    for line in (_PROC / 'cpuinfo').read_text().splitlines():
        name, _, value = line.partition(':')
        if name.strip() == 'model name':
            return ' '.join(value.split())
    return platform.machine()


def available_memory() -> int:
    """Return the memory available without swapping, bytes."""
    for line in (_PROC / 'meminfo').read_text().splitlines():
        name, _, rest = line.partition(':')
        if name == 'MemAvailable':
            return int(rest.split()[0]) * _KIB
    return os.sysconf('SC_AVPHYS_PAGES') * os.sysconf('SC_PAGE_SIZE')


def memory_of(pid: int) -> ProcessMemory:
    """Return the memory of one process."""
    sizes = {}
    for line in (_PROC / str(pid) / 'smaps_rollup').read_text().splitlines()[1:]:
        name, _, rest = line.partition(':')
        sizes[name] = int(rest.split()[0]) * _KIB
    return ProcessMemory(sizes['Rss'], sizes['Pss'])


def processor_seconds_of(pid: int) -> float:
    """Return the processor time of all threads of a process so far, s."""
    after_name = (_PROC / str(pid) / 'stat').read_text().rpartition(')')[2].split()
    ticks = int(after_name[_USER_TIME]) + int(after_name[_SYSTEM_TIME])
    return ticks / os.sysconf('SC_CLK_TCK')


def children_of(pid: int) -> list[int]:
    """Return the running child processes of a process."""
    children: list[int] = []
    for listed in (_PROC / str(pid) / 'task').glob('*/children'):
        with suppress(FileNotFoundError, ProcessLookupError):   # the thread has just ended
            children += map(int, listed.read_text().split())
    return sorted(children)
