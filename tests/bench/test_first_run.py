"""The first run of an installed wheel: what it is measured by; the wheel itself is `slow`."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

from isa_ros.bench import first_run
from isa_ros.errors import RunError
import pytest
from tests.bench.packages import package_in


def test_it_is_measured_on_request_and_in_a_checkout_only(tmp_path, monkeypatch):
    assert first_run.missing(False).startswith('needs --first-run')
    assert first_run.missing(True) == ''
    monkeypatch.setattr(first_run, 'ROOT', tmp_path)
    assert first_run.missing(True) == f'needs a checkout, {tmp_path} has no setup.py'


def test_processor_time_is_that_of_the_run_and_its_children(tmp_path):
    """A child of the run that works for 0.3 s counts."""
    work = ('import subprocess, sys, time\n'
            'if len(sys.argv) > 5:\n'
            '    subprocess.run([sys.executable, "-c", "import time\\n'
            'while time.process_time() < 0.3: pass"])\n')
    (package_in(tmp_path) / '__main__.py').write_text(work)
    spent, of_host = first_run._spent(tmp_path, Path(sys.executable), 'first')
    assert 0.3 <= spent and 0.3 <= of_host


def test_a_run_that_fails_says_why(tmp_path):
    (package_in(tmp_path) / '__main__.py').write_text('raise SystemExit("no such file")')
    with pytest.raises(RunError, match='^the second run of the wheel: no such file$'):
        first_run._spent(tmp_path, Path(sys.executable), 'second')


def test_kernels_that_cannot_be_made_say_why(tmp_path):
    """The checkout has no script that makes them; another one may be installed."""
    (tmp_path / 'scripts').mkdir()
    (tmp_path / 'scripts' / '__init__.py').touch()
    with pytest.raises(RunError, match='^kernels of the wheel: .*No module named .*scripts'):
        first_run._make_kernels(tmp_path, tmp_path)


def test_its_environment_has_no_kernels_and_no_checkout(tmp_path, monkeypatch):
    monkeypatch.setenv('NUMBA_CACHE_DIR', '/kept')
    monkeypatch.setenv('PYTHONPATH', '/checkout')
    monkeypatch.setenv('LANG', 'C.UTF-8')
    found = first_run._environment(tmp_path)
    assert 'NUMBA_CACHE_DIR' not in found and 'PYTHONPATH' not in found
    assert found['XDG_CACHE_HOME'] == str(tmp_path / 'cache') and found['LANG'] == 'C.UTF-8'
    assert found['HOME'] == str(tmp_path) != os.environ['HOME']


def test_the_row_is_the_first_run_over_its_aim(monkeypatch):
    """7 s are above 6; the second run and the host time stand below."""
    spent = iter([(7.0, 5.0), (1.5, 2.0)])
    made = []
    monkeypatch.setattr(first_run, '_make_kernels', lambda source, place: made.append(
        source / 'setup.py'))
    monkeypatch.setattr(first_run, '_pip', lambda *arguments: Path(
        arguments[arguments.index('--wheel-dir') + 1], 'a.whl').write_bytes(bytes(3 << 19)))
    monkeypatch.setattr(first_run, '_installed', lambda wheel, environment: environment)
    monkeypatch.setattr(first_run, '_spent', lambda *arguments: next(spent))
    row, host, second, size = first_run.first_run_rows()
    assert (row.value, row.is_reached) == (7.0, False)
    assert row.note == '5.0 s of host time; the second run 1.5 s'
    assert len(made) == 1 and made[0].name == 'setup.py'
    assert (host.value, second.value, size.value) == (5.0, 1.5, 1.5)
    assert {part.part_of for part in (host, second, size)} == {row.name}


def test_kernels_of_the_checkout_are_left_out(monkeypatch, tmp_path):
    """A wheel has those that were made for it; folders of that name elsewhere are kept."""
    for folder in ('isa_ros/kernels', 'isa_ros/core/kernels', 'kernels', 'build', '.venv'):
        (tmp_path / 'checkout' / folder).mkdir(parents=True)
    monkeypatch.setattr(first_run, 'ROOT', tmp_path / 'checkout')
    shutil.copytree(first_run.ROOT, tmp_path / 'copy', ignore=first_run._unneeded)
    found = {str(path.relative_to(tmp_path / 'copy')) for path in (tmp_path / 'copy').rglob('*')}
    assert found == {'isa_ros', 'isa_ros/core', 'isa_ros/core/kernels', 'kernels'}


@pytest.mark.slow
def test_the_wheel_is_that_of_the_checkout_with_what_it_needs(tmp_path, monkeypatch):
    """Installed aside, its package is its own and numba that of this Python."""
    def make(source, place):
        (source / 'isa_ros' / 'kernels').mkdir()
        (source / 'isa_ros' / 'kernels' / 'x86-64.so').write_bytes(b'made')
    monkeypatch.setattr(first_run, '_make_kernels', make)
    wheel = first_run._wheel(tmp_path)
    python = first_run._installed(wheel, tmp_path / 'environment')
    ended = subprocess.run(
        [str(python), '-c', 'import isa_ros, numba; print(isa_ros.__file__, numba.__file__)'],
        cwd=tmp_path, env=first_run._environment(tmp_path), capture_output=True, text=True)
    own, needed = ended.stdout.split()
    assert own.startswith(str(tmp_path)) and not needed.startswith(str(tmp_path))
    assert Path(own).with_name('kernels').joinpath('x86-64.so').read_bytes() == b'made'
    assert not (first_run.ROOT / 'build').exists()
