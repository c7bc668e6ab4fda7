"""The first call of `./isa`: its environment is made with progress, by a pip of the test."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
import os
from pathlib import Path
import pty
import select
import shutil
import signal
import subprocess
import time

import pytest
from tests.ros.started import wait_for

ROOT = Path(__file__).parents[1]
PINS = '# what is needed\none==1.0\ntwo==2.0\nthree==3.0; python_version < "3"\n\nfour==4.0\n'

PYTHON = r"""#!/bin/bash
# A python3 with a `venv`, a `pip` of three packages that waits for the test, and an `isa_ros`.
here=$(dirname "$0")
step() { until [[ -e $here/../../$1 ]]; do sleep 0.02; done; }
case "$*" in
    '-c import sys, venv;'*) ;;
    '-m venv '*) mkdir -p "$3/bin" "$3/lib/python3.9/site-packages/pip.dist-info"
        cp "$0" "$3/bin/python" ;;
    *--editable*) ;;
    *'pip install'*)
        site=$here/../lib/python3.9/site-packages
        echo "Ignoring three: markers 'python_version < \"3\"' don't match your environment"
        echo 'Collecting one==1.0 (from -r requirements.txt (line 2))'
        echo '  Downloading one-1.0-py3-none-any.whl.metadata (2 kB)'
        step a
        echo 'Collecting two==2.0'; echo 'Collecting four==4.0'
        echo 'Downloading one-1.0-py3-none-any.whl (6 kB)'
        echo '  Using cached two-2.0-py3-none-any.whl (1 kB)'
        step b
        echo 'Installing collected packages: one, two, four'
        mkdir "$site/one.dist-info"
        step c
        [[ ! -e $here/../../fails ]] || { echo 'ERROR: no space'; exit 1; }
        echo 'Successfully installed' ;;
    *) echo "ran $*" ;;
esac
"""

SLEEP = f'#!/bin/sh\nexec {shutil.which("sleep")} 0.05\n'
"""A pause between two looks at the progress, a tenth of that of `isa`."""


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """Return a clone of `isa` alone, with the python3 of the test first in its PATH."""
    shutil.copy(ROOT / 'isa', tmp_path / 'isa')
    (tmp_path / 'requirements.txt').write_text(PINS)
    (tmp_path / 'bin').mkdir()
    python = tmp_path / 'bin' / 'python3'
    python.write_text(PYTHON)
    python.chmod(0o755)
    return tmp_path


@pytest.fixture
def hurried(clone: Path) -> Path:
    """Return a clone that looks at the progress more often."""
    sleep = clone / 'bin' / 'sleep'
    sleep.write_text(SLEEP)
    sleep.chmod(0o755)
    return clone


class Call:
    """`./isa words` with its standard error on a terminal or in a pipe, read as it comes."""

    def __init__(self, clone: Path, error: int, write_end: int) -> None:
        self._error, self.text = error, ''
        self.process = subprocess.Popen(
            [clone / 'isa', 'words'], cwd=clone, stdout=subprocess.PIPE, stderr=write_end,
            text=True, env={'PATH': f'{clone / "bin"}:{os.environ["PATH"]}', 'TERM': 'dumb'},
            start_new_session=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        os.close(write_end)

    def wait_for(self, text: str) -> None:
        """Read until a text is there, then forget what was before its end."""
        deadline = time.monotonic() + 60.0
        while text not in self.text:
            assert time.monotonic() < deadline, f'{text!r} not in {self.text!r}'
            if select.select([self._error], [], [], 0.1)[0]:
                self.text += os.read(self._error, 4096).decode()
        self.text = self.text.partition(text)[2]


@contextmanager
def called(clone: Path, on_terminal: bool) -> Iterator[Call]:
    """Run the first call while the context lasts; the pip that waits for the test ends too."""
    error, write_end = pty.openpty() if on_terminal else os.pipe()
    call = Call(clone, error, write_end)
    try:
        yield call
    finally:
        with suppress(ProcessLookupError):
            os.killpg(call.process.pid, signal.SIGKILL)
        call.process.wait()
        os.close(error)


@pytest.mark.parametrize('on_terminal', [True, False])
def test_pip_is_shown_with_its_phases_and_totals(hurried: Path, on_terminal: bool) -> None:
    """What a marker excludes is not among the total; the second call is silent."""
    with called(hurried, on_terminal) as call:
        title = 'installing requirements.txt, once: '
        call.wait_for(f'{title}collecting {"1 of 3 packages" if on_terminal else ""}')
        (hurried / 'a').touch()
        # A pipe has a line for each phase, with the numbers that it began with.
        call.wait_for('downloading 2 of 3 packages' if on_terminal else 'downloading ')
        (hurried / 'b').touch()
        call.wait_for('installing 1 of 3 packages' if on_terminal else f'{title}installing ')
        (hurried / 'c').touch()
        call.wait_for(f'{title}done in ')
        call.wait_for('installing isa_ros: done in ')
        assert call.process.wait(60) == 0
        assert call.process.stdout is not None
        assert call.process.stdout.read() == 'ran -m isa_ros words\n'
    again = subprocess.run(
        [hurried / 'isa', 'words'], capture_output=True, text=True, check=True)
    assert not again.stderr


def test_on_a_terminal_nothing_is_silent_for_two_seconds(clone: Path) -> None:
    """While pip waits its line is written again, with the seconds: two of them differ by one."""
    with called(clone, on_terminal=True) as call:
        call.wait_for('collecting 1 of 3 packages, 1 s')
        call.wait_for('collecting 1 of 3 packages, 2 s')


def test_a_pip_that_fails_is_3_with_the_end_of_its_log(hurried: Path) -> None:
    for name in ('a', 'b', 'c', 'fails'):
        (hurried / name).touch()
    with called(hurried, on_terminal=False) as call:
        call.wait_for('ERROR: no space')
        call.wait_for(f'cannot install requirements.txt: the log is {hurried}/.venv/pip.log')
        assert call.process.wait(60) == 3
    assert not (hurried / '.venv' / 'requirements.txt').exists()


def test_an_interrupt_ends_pip_too(hurried: Path) -> None:
    """What runs in the background of a script would ignore it."""
    with called(hurried, on_terminal=True) as call:
        call.wait_for('collecting 1 of 3 packages')
        pip = subprocess.run(
            ['pgrep', '-P', str(call.process.pid), '-f', 'pip install'], check=True,
            capture_output=True, text=True).stdout.split()
        call.process.send_signal(signal.SIGINT)
        call.wait_for('isa: interrupted')
        assert call.process.wait(60) == 130
        wait_for(lambda: not any(Path(f'/proc/{own}').exists() for own in pip), 'the end of pip')


MADE = 'ran -m scripts.make_kernels\n'


@pytest.fixture
def ready(clone: Path) -> Path:
    """Return a clone with its environment and what makes kernels."""
    (clone / '.venv' / 'bin').mkdir(parents=True)
    shutil.copy(clone / 'bin' / 'python3', clone / '.venv' / 'bin' / 'python')
    shutil.copy(clone / 'requirements.txt', clone / '.venv')
    (clone / 'scripts').mkdir()
    (clone / 'scripts' / 'make_kernels.py').touch()
    return clone


def said(clone: Path, *words: str, **environment: str) -> tuple[str, str]:
    """Return what a call says on both streams."""
    path = f'{clone / "bin"}:{os.environ["PATH"]}'
    done = subprocess.run([clone / 'isa', *words], capture_output=True, text=True, check=True,
                          env={'PATH': path, **environment})
    return done.stdout, done.stderr


def test_kernels_are_made_before_the_first_simulation(ready: Path) -> None:
    """Not for other commands or for help, not without a compiled simulation, and once."""
    for words in (('--help',), ('demo', '--help'), ('bringup', 'leg', '-h')):
        assert said(ready, *words) == (f'ran -m isa_ros {" ".join(words)}\n', '')
    assert said(ready, 'demo', '--out', 'a-h') == ('ran -m isa_ros demo --out a-h\n', MADE)
    assert said(ready, 'demo', NUMBA_DISABLE_JIT='1') == ('ran -m isa_ros demo\n', '')
    assert said(ready, 'demo') == ('ran -m isa_ros demo\n', MADE)
    assert said(ready, 'step', 'isa_v5') == ('ran -m isa_ros step isa_v5\n', MADE)
    (ready / 'isa_ros' / 'kernels').mkdir(parents=True)
    (ready / 'isa_ros' / 'kernels' / 'x86-64.so').touch()
    assert said(ready, 'demo') == ('ran -m isa_ros demo\n', '')


def test_kernels_are_made_before_the_whole_suite(ready: Path) -> None:
    """
    For all processors of this kind, by all cores; chosen tests compile what they need.

    A worker for each core and one more.
    """
    workers = len(os.sched_getaffinity(0)) + 1
    shutil.copy(ready / 'requirements.txt', ready / 'requirements-test.txt')
    shutil.copy(ready / 'requirements.txt', ready / '.venv' / 'requirements-test.txt')
    made = MADE.replace('\n', ' --own\n')
    assert said(ready, 'test', '-k', 'valve') == ('ran -m pytest -k valve\n', '')
    assert said(ready, 'test', '-x') == (
        f'ran -c import xdist\nran -m pytest -n {workers} -x\n', made)
    assert said(ready, 'test', '--quick') == (
        f'ran -c import xdist\nran -m pytest --quick -n {workers}\n', made)
    assert said(ready, 'test', NUMBA_DISABLE_JIT='1')[1] == ''


def test_a_link_to_it_is_the_clone(ready: Path, tmp_path: Path) -> None:
    """From another folder, also by two links; nothing is made beside them."""
    folder = tmp_path / 'links'
    folder.mkdir()
    (folder / 'first').symlink_to(ready / 'isa')
    (folder / 'isa').symlink_to('first')
    found = subprocess.run([folder / 'isa', '--help'], capture_output=True, text=True,
                           cwd=folder, env={'PATH': f'{ready / "bin"}:{os.environ["PATH"]}'})
    assert (found.stdout, found.stderr) == ('ran -m isa_ros --help\n', '')
    assert sorted(path.name for path in folder.iterdir()) == ['first', 'isa']


def test_a_copy_without_scripts_makes_no_kernels(ready: Path) -> None:
    """As an archive of a package has none."""
    (ready / 'scripts' / 'make_kernels.py').unlink()
    assert said(ready, 'demo') == ('ran -m isa_ros demo\n', '')


@pytest.mark.parametrize(('code', 'expected'), [(130, 130), (1, 0)])
def test_an_interrupt_ends_the_call_and_a_failure_does_not(
        ready: Path, code: int, expected: int) -> None:
    python = ready / '.venv' / 'bin' / 'python'
    python.write_text(PYTHON.replace(
        '    *) echo', f'    "-m scripts.make_kernels") exit {code} ;;\n    *) echo'))
    done = subprocess.run([ready / 'isa', 'demo'], capture_output=True, text=True)
    assert done.returncode == expected
    assert done.stdout == ('' if expected else 'ran -m isa_ros demo\n')
