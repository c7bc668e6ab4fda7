"""Versions: isa_ros, Python, and the packages that it needs or may use."""

from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
import platform
import sys

from isa_ros.cli.doctor.finding import Finding, Verdict
from isa_ros.core.version import VERSION

NEEDED = ('numpy', 'scipy', 'numba', 'mcap', 'lz4', 'zstandard', 'PyYAML', 'matplotlib', 'pillow')
"""Distributions without which runs or reports fail: those that setup.py requires."""

OPTIONAL = {
    'canopen': ('canopen', 'isa bus canopen'), 'python-can': ('canopen', 'isa bus canopen'),
    'msgpack': ('canopen', 'CAN over UDP'),
    'mujoco': ('mujoco', 'MuJoCo as the body of a run'),
    'pysoem': ('ethercat', 'the example of an EtherCAT master'),
    'pin': ('pinocchio', 'the example with Pinocchio')}
"""Distribution -> extra of setup.py, and what it is for."""

LEAST_PYTHON = (3, 10)
_GROUP = 'software'


def software() -> Iterator[Finding]:
    """Yield what is installed, in which version."""
    yield Finding(_GROUP, 'isa_ros', f'{VERSION}, {Path(__file__).parents[3]}')
    yield _python(sys.version_info[:3])
    for name in NEEDED:
        found = installed(name)
        yield Finding(_GROUP, name, found) if found else Finding(
            _GROUP, name, 'missing', Verdict.PROBLEM, f'pip install {name}')
    for name, (extra, purpose) in OPTIONAL.items():
        found = installed(name)
        yield Finding(_GROUP, name, found) if found else Finding(
            _GROUP, name, 'not installed', Verdict.NOTE,
            f"only for {purpose}: pip install -e '.[{extra}]' in a clone")


def _python(number: tuple[int, ...]) -> Finding:
    text = f'{".".join(map(str, number))} {platform.machine()}'
    if number < LEAST_PYTHON:
        return Finding(_GROUP, 'Python', text, Verdict.PROBLEM,
                       f'must be {".".join(map(str, LEAST_PYTHON))} or later')
    return Finding(_GROUP, 'Python', text)


def installed(name: str) -> str:
    """Return the installed version of a distribution, '' without one."""
    try:
        return version(name)
    except PackageNotFoundError:
        return ''
