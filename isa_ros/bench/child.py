"""Child processes of the bench: modules of this package."""

from collections.abc import Mapping, Sequence
import os
from pathlib import Path
import subprocess
import sys
import time

import isa_ros

Ended = subprocess.CompletedProcess[str]

ROOT = Path(isa_ros.__file__).parents[1]
"""The checkout, or the packages of an installation."""
_NO_BYTECODE = 'PYTHONDONTWRITEBYTECODE'


def environment(added: Mapping[str, str] | None = None, root: Path = ROOT) -> dict[str, str]:
    """
    Return this process's environment, with the packages of ``root`` first in Python's path.

    Python keeps their bytecode, as an installation has it: compiling it takes 0.14 s of a start.
    """
    path = [str(root), *filter(None, [os.environ.get('PYTHONPATH')])]
    own = {name: value for name, value in os.environ.items() if name != _NO_BYTECODE}
    return {**own, 'PYTHONPATH': os.pathsep.join(path), **(added or {})}


def run_module(
        module: str, arguments: Sequence[str], timeout_s: float, root: Path = ROOT) -> Ended:
    """
    Run ``python -m module STARTED *arguments`` to its end and return its output.

    STARTED is the monotonic clock just before; after ``timeout_s`` the process is killed. The
    module is that of ``root``.
    """
    return subprocess.run(
        [sys.executable, '-m', module, str(time.monotonic()), *arguments],
        env=environment(root=root), cwd=root, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        errors='replace', timeout=timeout_s)


def last_line(ended: Ended) -> str:
    """Return the last line of a failed process's errors."""
    lines = ended.stderr.strip().splitlines()
    return lines[-1] if lines else f'exit code {ended.returncode}'
