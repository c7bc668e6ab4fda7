"""Forked copies of a process, made by a separate script without other work."""

from pathlib import Path
import subprocess
import sys
import textwrap

from isa_ros.processes import forked
import pytest
from tests.ros.domains import held_domain

START = """
import contextlib, os, signal, socket, subprocess, sys, threading, time
from pathlib import Path
from isa_ros.processes.forked import can_fork, Forked

def wait_for(condition):
    deadline = time.monotonic() + 20.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.001)
"""


def run(script: str) -> subprocess.CompletedProcess[str]:
    """Run a script behind `START` to its end."""
    done = subprocess.run(
        [sys.executable, '-c', START + textwrap.dedent(script)], capture_output=True, text=True,
        timeout=60.0)
    assert done.returncode == 0, done.stderr
    return done


def test_a_copy_works_and_its_exit_code_is_returned():
    """With the state before the fork, in its own process and session."""
    done = run("""
        known = 'before'
        def work():
            print(known, os.getpid() != parent, os.getsid(0) == os.getpid())
            return 7
        parent = os.getpid()
        copy = Forked('haa', work)
        assert copy.wait(20.0) == copy.poll() == copy.returncode == 7
        print('after')
        """)
    assert done.stdout.splitlines() == ['before True True', 'after']


def test_a_copy_has_its_name():
    run("""
        copy = Forked('haa', lambda: signal.pause() or 0)
        wait_for(lambda: Path(f'/proc/{copy.pid}/comm').read_text() == 'haa\\n')
        copy.kill()
        assert copy.wait(20.0) == -signal.SIGKILL
        """)


def test_a_signal_that_comes_at_once_is_not_lost():
    run("""
        for _ in range(50):
            copy = Forked('haa', lambda: signal.pause() or 0)
            copy.terminate()
            assert copy.wait(20.0) == -signal.SIGTERM
        assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == set()
        """)


def test_the_handlers_of_the_original_are_not_those_of_the_copy():
    run("""
        signal.signal(signal.SIGTERM, lambda number, frame: None)
        copy = Forked('haa', lambda: signal.pause() or 0)
        copy.terminate()
        assert copy.wait(20.0) == -signal.SIGTERM
        """)


def test_a_copy_that_does_not_end_in_time_is_told():
    run("""
        copy = Forked('haa', lambda: signal.pause() or 0)
        try:
            copy.wait(0.01)
        except subprocess.TimeoutExpired:
            assert copy.poll() is None
            copy.kill()
            copy.wait()
            copy.kill()
        """)


def test_a_copy_holds_no_file_of_the_original():
    """A name that the original has claimed is free once the original releases it."""
    run("""
        claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        claim.bind(f'\\0isa_ros/test_forked/{os.getpid()}')
        copy = Forked('haa', lambda: signal.pause() or 0)

        def held():
            for file in Path(f'/proc/{copy.pid}/fd').iterdir():
                with contextlib.suppress(FileNotFoundError):  # closed since it was listed
                    if int(file.name) not in (1, 2):
                        yield os.readlink(file)

        wait_for(lambda: set(held()) == {os.devnull})
        name = claim.getsockname()
        claim.close()
        socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM).bind(name)
        copy.kill()
        copy.wait()
        """)


def test_what_a_copy_raises_is_one_line_and_ends_it_alone():
    """An exception that the work of a copy lets through is a defect."""
    done = run("""
        def fail():
            raise KeyError('no such thing')
        try:
            assert Forked('haa', fail).wait(20.0) == 70
            assert Forked('kfe', lambda: sys.exit(3)).wait(20.0) == 3
        finally:
            print('once')
        """)
    assert done.stdout == 'once\n'
    line, = done.stderr.splitlines()
    assert line.startswith("haa: a defect of isa_ros, KeyError: 'no such thing'")


def test_a_process_with_another_thread_is_not_copied():
    run("""
        assert can_fork()
        done = threading.Event()
        thread = threading.Thread(target=done.wait)
        thread.start()
        assert not can_fork()
        done.set()
        thread.join()
        assert can_fork()
        """)


@pytest.mark.parametrize('error', [FileNotFoundError, ProcessLookupError])
def test_a_thread_that_has_just_ended_has_no_name(error, monkeypatch):
    """Before its file is opened, or before it is read."""
    def read(path):
        raise error
    monkeypatch.setattr(Path, 'read_text', read)
    assert forked._thread_names() == set()


@pytest.mark.ros
def test_a_process_with_a_node_is_not_copied(monkeypatch):
    """The middleware's threads would be missing in the copy, and their locks would stay held."""
    with held_domain(monkeypatch):
        run("""
            from isa_ros.nodes.middleware.environment import set_defaults
            set_defaults()
            import rclpy
            assert can_fork()
            rclpy.init()
            node = rclpy.create_node('only')
            assert not can_fork()
            """)
