"""
Run a scenario with a real master in a network namespace of its own, without root.

A pair of virtual interfaces joins the master's end `ecm` and the slaves' end `ecs`; both names
are the namespace's own, so that any number of tests can run on one host.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
import json
from pathlib import Path
import shutil
import subprocess
import sys
from typing import Any

import pytest

ROOT = Path(__file__).parents[3]
MASTER, SLAVES = 'ecm', 'ecs'
_LONGEST = 60.0


@cache
def run(scenario: str, *arguments: str) -> Any:
    """
    Return what a scenario of `scenarios.py` has found; it runs once for all tests that ask.

    Skip where namespaces are refused.
    """
    if shutil.which('unshare') is None or shutil.which('ip') is None or subprocess.run(
            ['unshare', '-rn', 'true'], capture_output=True, check=False).returncode:
        pytest.skip('the kernel refuses network namespaces without root (unshare -rn)')
    done = subprocess.run(
        ['unshare', '-rn', sys.executable, '-m', 'tests.fieldbus.ethercat.scenarios', scenario,
         *arguments], cwd=ROOT, capture_output=True, text=True, timeout=_LONGEST, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def make_interfaces() -> None:
    """Make the pair of interfaces; within the namespace."""
    for command in (f'ip link add {SLAVES} type veth peer name {MASTER}',
                    f'ip link set {SLAVES} up', f'ip link set {MASTER} up'):
        subprocess.run(command.split(), check=True)


@contextmanager
def served(*options: str) -> Iterator[None]:
    """Serve toys in a process of its own while the context lasts."""
    server = subprocess.Popen(
        [sys.executable, '-m', 'tests.fieldbus.ethercat.serve_toys', SLAVES, *options],
        cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None and server.stdout.readline() == 'serving\n'
        yield
        assert server.poll() is None, 'the slaves ended'
    finally:
        server.kill()
        server.wait()
