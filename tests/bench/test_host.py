"""The kernel's data on processes."""

import os
from pathlib import Path
import subprocess
import sys

from isa_ros.bench import host
import pytest

_HOLD_64_MIB = 'b = b"x" * 2**26; print(len(b), flush=True); input()'


def test_a_child_is_seen_with_its_memory_until_it_ends():
    """64 MiB more in the child than a bare interpreter has; proportional is never more."""
    with subprocess.Popen([sys.executable, '-c', _HOLD_64_MIB], stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE) as child:
        child.stdout.readline()
        assert child.pid in host.children_of(os.getpid())
        size = host.memory_of(child.pid)
        assert 2**26 < size.resident < 2**26 + 2**25
        assert 2**26 < size.proportional <= size.resident
        child.communicate(b'\n')
    assert child.pid not in host.children_of(os.getpid())


@pytest.mark.parametrize('error', [FileNotFoundError, ProcessLookupError])
def test_a_thread_that_has_just_ended_has_no_children(error, monkeypatch):
    """Before its file is opened, or before it is read."""
    read = Path.read_text

    def read_of_others(path):
        if path.parent.name == str(os.getpid()):
            raise error
        return read(path)
    monkeypatch.setattr(Path, 'read_text', read_of_others)
    with subprocess.Popen(['sleep', '60']) as child:
        without = host.children_of(os.getpid())
        monkeypatch.undo()
        of_all = host.children_of(os.getpid())
        child.kill()
    assert child.pid not in without and child.pid in of_all


def test_processor_time_counts_work():
    before = host.processor_seconds_of(os.getpid())
    while host.processor_seconds_of(os.getpid()) == before:
        sum(range(1000))
    assert 0.0 < host.processor_seconds_of(os.getpid()) - before < 1.0


def test_the_machine_says_what_numbers_are_from():
    here = host.machine()
    assert here.cores >= 1 and here.memory_gib > 0.1
    assert f'{here.cores} cores' in here.summary and here.processor in here.summary
