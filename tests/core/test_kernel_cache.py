"""The directory of compiled kernels: a writable one, and never an old equation from it."""

from collections.abc import Mapping
import os
from pathlib import Path
import shutil
import subprocess
import sys

import isa_ros
from isa_ros.core import kernel_cache
from isa_ros.core.kernel_cache import cache_directories
import pytest

PACKAGE = Path(isa_ros.__file__).parent
CALLER = """
from isa_ros.core.kernel import kernel
from isa_ros.callee import twice
@kernel
def caller(x):
    return twice(x)
"""
CALLEE = """
from isa_ros.core.kernel import kernel
@kernel
def twice(x):
    return {factor} * x
"""
MAIN = (
    'from isa_ros.caller import caller; import numba; '
    'print(caller(1.0), numba.config.CACHE_DIR)')


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Return a package with the kernels `caller` and `twice` and the core of this one."""
    shutil.copytree(PACKAGE / 'core', tmp_path / 'isa_ros' / 'core')
    for name in ('__init__.py', 'errors.py'):
        shutil.copy(PACKAGE / name, tmp_path / 'isa_ros')
    (tmp_path / 'isa_ros' / 'caller.py').write_text(CALLER)
    (tmp_path / 'isa_ros' / 'callee.py').write_text(CALLEE.format(factor=2.0))
    return tmp_path


def called(package: Path, **environment: str) -> tuple[str, str]:
    """Return what `MAIN` prints, and what it says on standard error."""
    kept = {name: value for name, value in os.environ.items()
            if name not in ('NUMBA_CACHE_DIR', 'XDG_CACHE_HOME', 'HOME')}
    done = subprocess.run(
        [sys.executable, '-c', MAIN], env=kept | {'PYTHONPATH': str(package)} | environment,
        cwd=package, capture_output=True, text=True, timeout=120.0)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def test_an_edit_is_noticed_in_a_directory_of_the_user_too(package: Path) -> None:
    """Only the callee is edited, and numba looks at the caller's file alone; `CACHE_DIR` stays."""
    own = str(package / 'own')
    assert called(package, NUMBA_CACHE_DIR=own) == (f'2.0 {own}\n', '')
    assert [path.name for path in (package / 'own').iterdir()] == ['isa_ros']
    (package / 'isa_ros' / 'callee.py').write_text(CALLEE.format(factor=3.0))
    assert called(package, NUMBA_CACHE_DIR=own) == (f'3.0 {own}\n', '')


@pytest.mark.parametrize('environment', [
    {}, {'NUMBA_CACHE_DIR': '/dev/null/x', 'HOME': '/dev/null/x'}])
def test_a_home_that_cannot_be_written_is_replaced(
        package: Path, environment: Mapping[str, str]) -> None:
    """A user of a container: no home, or one that is not there."""
    temporary = package / 'tmp'
    temporary.mkdir()
    if 'HOME' not in environment:
        (package / 'sitecustomize.py').write_text(  # a user that /etc/passwd does not have
            'from pathlib import Path\n'
            'def home():\n    raise RuntimeError("Could not determine home directory")\n'
            'Path.home = staticmethod(home)\n')
    said, errors = called(package, TMPDIR=str(temporary), **environment)
    assert (said.split()[0], errors) == ('2.0', '')
    assert list(temporary.glob(f'isa_ros-{os.geteuid()}/kernels/callee.twice-*'))
    assert not list((package / 'isa_ros').rglob('*.twice-*'))


def test_without_any_directory_one_line_says_so(package: Path) -> None:
    (package / 'sitecustomize.py').write_text(
        'import os\nos.access = lambda *arguments: False\n')
    said, errors = called(package)
    assert said.split()[0] == '2.0'
    assert errors.startswith('isa_ros: compiled kernels cannot be kept, no directory is writable')
    assert errors.count('\n') == 1
    assert not list(package.rglob('*.nb?'))


def test_a_directory_that_others_can_write_is_not_used(
        monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is loaded from it is run."""
    first, second = tmp_path / 'first' / 'isa_ros', tmp_path / 'second'
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(first.parent))
    monkeypatch.setenv('XDG_CACHE_HOME', str(second))
    assert cache_directories() == (first / 'kernels', (first / 'kernels',))
    first.chmod(0o777)
    second = second / 'isa_ros' / 'kernels'
    assert cache_directories() == (second, (second,))


def twice(x):
    return x + x


def test_a_full_disk_is_one_line_and_the_kernel_runs(
        monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
        capsys: pytest.CaptureFixture[str]) -> None:
    from isa_ros.core import kernel as kernels
    kernel_cache._say_not_kept.cache_clear()
    monkeypatch.setattr(kernels, 'CACHE', tmp_path)
    compiled = kernels.kernel(twice)
    monkeypatch.setattr(
        kernel_cache, '_write', lambda *_: (_ for _ in ()).throw(OSError(28, 'full')))
    assert (compiled(3), compiled(1.5)) == (6, 3.0)
    line, = capsys.readouterr().err.splitlines()
    assert 'cannot be kept, full' in line
