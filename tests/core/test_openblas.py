"""Libraries begin no threads for matrices where a program asks for none, and the user for none."""

import subprocess
import sys

from isa_ros.core.openblas import VARIABLE, without_threads
import pytest
from tests.threads import forget_number

THREADS = """
import os
import numpy
import scipy.linalg
print(len(os.listdir('/proc/self/task')))
"""
CALLED = f'from isa_ros.core.openblas import without_threads\nwithout_threads()\n{THREADS}'


def threads(program: str) -> int:
    """Return how many a process has that has loaded both libraries."""
    return int(subprocess.run(
        [sys.executable, '-c', program], capture_output=True, text=True, check=True).stdout)


def test_none_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    forget_number(monkeypatch)
    assert threads(CALLED) == 1


def test_they_begin_where_nobody_refuses_or_the_user_wants_them(
        monkeypatch: pytest.MonkeyPatch) -> None:
    forget_number(monkeypatch)
    monkeypatch.setenv(VARIABLE, '2')
    found = threads(CALLED)
    if found == 1:
        pytest.skip('these libraries begin no threads, or this process has one core')
    monkeypatch.delenv(VARIABLE)
    assert found > 1 and threads(THREADS) > 1


@pytest.mark.parametrize('name', [
    'OPENBLAS_NUM_THREADS', 'GOTO_NUM_THREADS', 'OMP_NUM_THREADS',
    'OPENBLAS_DEFAULT_NUM_THREADS'])
def test_what_the_user_has_set_stays(name: str) -> None:
    own = {'HOME': '/home', name: '3'}
    without_threads(own)
    assert own == {'HOME': '/home', name: '3'}


@pytest.mark.parametrize('own', [{}, {'HOME': '/home'}, {'OMP_NUM_THREADS': ''}, {VARIABLE: ''}])
def test_what_is_empty_is_not_set(own: dict[str, str]) -> None:
    before = dict(own)
    without_threads(own)
    assert own == before | {VARIABLE: '1'}
