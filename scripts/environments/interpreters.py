"""The interpreters of a host: on the PATH, and those of pyenv."""

from collections.abc import Iterator
from pathlib import Path
import shutil
import subprocess

PYTHONS = ('3.10', '3.11', '3.12', '3.13')


def find(minor: str) -> Path | None:
    """Return an interpreter ``3.N`` that runs and can make environments; None: there is none."""
    return next((path for path in _candidates(minor) if _runs(path, minor)), None)


def _candidates(minor: str) -> Iterator[Path]:
    found = shutil.which(f'python{minor}')
    if found:
        yield Path(found)
    yield from sorted(Path.home().glob(f'.pyenv/versions/{minor}.*/bin/python{minor}'))


def _runs(path: Path, minor: str) -> bool:
    """Return whether it is one: pyenv puts shims on the PATH for versions that are not in use."""
    program = "import sys, venv; print('%d.%d' % sys.version_info[:2])"
    try:
        done = subprocess.run(
            [path, '-c', program], capture_output=True, text=True, timeout=60, check=False)
    except OSError:
        return False
    return done.returncode == 0 and done.stdout.strip() == minor
