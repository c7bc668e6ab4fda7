"""One environment with the package's wheel, made by uv: how new its packages are, and its runs."""

from collections.abc import Sequence
import os
from pathlib import Path
import re
import subprocess
import time
from typing import NamedTuple
import zipfile

NEWEST, LOWEST = 'newest', 'lowest'
RESOLUTIONS = {NEWEST: 'highest', LOWEST: 'lowest-direct'}
"""Of uv: ``lowest-direct`` takes the oldest version that is allowed and has a file here."""
SOURCES = ('empy',)
"""Packages without a wheel: what generates ROS messages."""
_NEEDED = re.compile(r'^Requires-Dist: ([^;\n]+?)(?:; *extra == ["\'](\w+)["\'])?$', re.MULTILINE)


class CommandResult(NamedTuple):
    """What a command in an environment did."""

    is_good: bool
    seconds: float
    output: str

    @property
    def last_line(self) -> str:
        """Return the last line that was printed, '' if none."""
        return (self.output.strip().splitlines() or [''])[-1]


def needed(wheel: Path, extra: str = '') -> list[str]:
    """Return what a wheel says that it needs, without extras or for one of them."""
    with zipfile.ZipFile(wheel) as archive:
        name = next(name for name in archive.namelist() if name.endswith('.dist-info/METADATA'))
        text = archive.read(name).decode('utf-8')
    return [found[1] for found in _NEEDED.finditer(text) if (found[2] or '') == extra]


class Environment:
    """An environment below a folder, with the wheel; files that its runs leave are there too."""

    def __init__(self, folder: Path, python: Path, versions: str) -> None:
        self.versions = versions
        self._folder = folder
        self._python = python

    @property
    def python(self) -> Path:
        """Return its interpreter."""
        return self._folder / 'bin' / 'python'

    def make(self, wheel: Path) -> CommandResult:
        """Make it: first what the wheel needs, each by name, then the wheel alone."""
        made = self._uv('venv', '--quiet', '--python', str(self._python), str(self._folder))
        if not made.is_good:
            return made
        installed = self.install(needed(wheel))
        if not installed.is_good:
            return installed
        return self._uv(
            'pip', 'install', '--quiet', '--python', str(self.python), '--no-deps', str(wheel))

    def install(self, requirements: Sequence[str]) -> CommandResult:
        """Add packages; of those in `SOURCES` alone a file that is to be built is taken."""
        return self._uv(
            'pip', 'install', '--quiet', '--python', str(self.python), '--only-binary', ':all:',
            *(f'--no-binary={name}' for name in SOURCES),
            '--resolution', RESOLUTIONS[self.versions], *requirements)

    def run(self, *command: str | Path, within: Path | None = None,
            timeout: float = 3600.0) -> CommandResult:
        """Run a command of the environment, with its own kernels, away from any checkout."""
        program, *arguments = map(str, command)
        return outcome(
            [str(self._folder / 'bin' / program), *arguments], within or self._folder, timeout,
            NUMBA_CACHE_DIR=str(self._folder / 'cache'))

    def version_of(self, package: str) -> str:
        """Return the installed version, '-' if there is none."""
        done = self.run('python', '-c', (
            f'from importlib.metadata import version; print(version({package!r}))'))
        return done.last_line if done.is_good else '-'

    def _uv(self, *arguments: str) -> CommandResult:
        return outcome(['uv', *arguments], self._folder.parent, 600.0)


def outcome(
        command: Sequence[str], folder: Path, timeout: float, **environment: str) -> CommandResult:
    """Run a command to its end, or to its limit, s; its output and errors are one text."""
    started = time.monotonic()
    clean = {name: value for name, value in os.environ.items()
             if name not in ('PYTHONPATH', 'VIRTUAL_ENV', 'PYTHONHOME')}
    try:
        done = subprocess.run(
            command, cwd=folder, env={**clean, 'UV_PYTHON_DOWNLOADS': 'never', **environment},
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout,
            check=False)
    except subprocess.TimeoutExpired:
        return CommandResult(
            False, time.monotonic() - started, f'not finished after {timeout:.0f} s')
    except OSError as error:
        return CommandResult(False, 0.0, f'{command[0]}: {error.strerror}')
    return CommandResult(done.returncode == 0, time.monotonic() - started, done.stdout)
