"""A program's libraries begin no threads for matrices, unless the user asks for them."""

import os
import subprocess
import sys

from isa_ros.core.openblas import VARIABLE, without_threads
import pytest

THREADS = """
import os
import numpy
import scipy.linalg
print(len(os.listdir('/proc/self/task')))
"""
CALLED = f'from isa_ros.core.openblas import without_threads\nwithout_threads()\n{THREADS}'


def threads(program: str, **own: str) -> int:
    """Return how many a process has that has loaded both libraries."""
    inherited = {name: value for name, value in os.environ.items() if name != VARIABLE}
    return int(subprocess.run(
        [sys.executable, '-c', program], capture_output=True, text=True, check=True,
        env=inherited | own).stdout)


def test_none_begins() -> None:
    assert threads(CALLED) == 1


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason='one core has one thread')
def test_they_begin_where_nobody_refuses_or_the_user_wants_them() -> None:
    assert threads(THREADS) > 1
    assert threads(CALLED, **{VARIABLE: '2'}) == 3   # one more for each library


@pytest.mark.parametrize('set_by_user, then', [
    ({}, {VARIABLE: '1'}),
    ({'HOME': '/home'}, {'HOME': '/home', VARIABLE: '1'}),
    ({VARIABLE: '3'}, {VARIABLE: '3'}),
    ({'OMP_NUM_THREADS': '4'}, {'OMP_NUM_THREADS': '4'}),
    ({'GOTO_NUM_THREADS': '2'}, {'GOTO_NUM_THREADS': '2'}),
    ({'OMP_NUM_THREADS': ''}, {'OMP_NUM_THREADS': '', VARIABLE: '1'})])
def test_what_the_user_has_set_stays(set_by_user: dict[str, str], then: dict[str, str]) -> None:
    without_threads(set_by_user)
    assert set_by_user == then
