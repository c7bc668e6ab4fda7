"""The directory of compiled kernels: a writable one, and never an old equation from it."""

from collections.abc import Mapping
import os
from pathlib import Path
import shutil
import subprocess
import sys
import time

import isa_ros
from isa_ros.core import kernel as kernels
from isa_ros.core import kernel_cache, kernel_directory
from isa_ros.core.kernel_directory import cache_directories, is_kept
import numba
import numpy as np
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
from isa_ros.core.kernel import {decorator}
@{decorator}
def twice(x):
    return {factor} * x
"""
MAIN = (
    'import numba; from isa_ros.caller import caller; '
    'print(caller(1.0), numba.config.CACHE_DIR)')
LOADED = (
    'import sys; from isa_ros.callee import twice; '
    'print(twice(1.0), "numba.np.arraymath" in sys.modules)')
THEN_COMPILED = f'{LOADED}; from isa_ros.caller import caller; print(caller(2.0))'


def callee(factor: float = 2.0, decorator: str = 'kernel') -> str:
    """Return the module of the callee."""
    return CALLEE.format(factor=factor, decorator=decorator)


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Return a package with the kernels `caller` and `twice` and the core of this one."""
    shutil.copytree(PACKAGE / 'core', tmp_path / 'isa_ros' / 'core')
    for name in ('__init__.py', 'errors.py'):
        shutil.copy(PACKAGE / name, tmp_path / 'isa_ros')
    (tmp_path / 'isa_ros' / 'caller.py').write_text(CALLER)
    (tmp_path / 'isa_ros' / 'callee.py').write_text(callee())
    return tmp_path


def called(package: Path, program: str = MAIN, **environment: str) -> tuple[str, str]:
    """Return what a program prints, and what it says on standard error."""
    kept = {name: value for name, value in os.environ.items()
            if name not in ('NUMBA_CACHE_DIR', 'XDG_CACHE_HOME', 'HOME')}
    done = subprocess.run(
        [sys.executable, '-B', '-c', program],   # two edits may fall into one second of a .pyc
        env=kept | {'PYTHONPATH': str(package)} | environment, cwd=package,
        capture_output=True, text=True, timeout=120.0)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


@pytest.mark.parametrize('decorator', ['kernel', 'part_of_kernel', 'called_kernel'])
def test_an_edit_is_noticed_in_a_directory_of_the_user_too(
        package: Path, decorator: str) -> None:
    """Only the callee is edited, and numba looks at the caller's file alone; `CACHE_DIR` stays."""
    own = str(package / 'own')
    (package / 'isa_ros' / 'callee.py').write_text(callee(2.0, decorator))
    assert called(package, NUMBA_CACHE_DIR=own) == (f'2.0 {own}\n', '')
    assert [path.name for path in (package / 'own').iterdir()] == ['isa_ros']
    (package / 'isa_ros' / 'callee.py').write_text(callee(3.0, decorator))
    assert called(package, NUMBA_CACHE_DIR=own) == (f'3.0 {own}\n', '')


def test_loading_needs_no_compiler_and_a_later_kernel_is_compiled_with_what_was_loaded(
        package: Path) -> None:
    """The compiler's declarations come in only when the second kernel is not kept."""
    own = str(package / 'own')
    assert called(package, LOADED, NUMBA_CACHE_DIR=own) == ('2.0 True\n', '')
    assert called(package, LOADED, NUMBA_CACHE_DIR=own) == ('2.0 False\n', '')
    assert called(package, THEN_COMPILED, NUMBA_CACHE_DIR=own) == ('2.0 False\n4.0\n', '')


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
    kernel_cache.say_not_kept.cache_clear()
    monkeypatch.setattr(kernels, 'CACHE', tmp_path)
    compiled = kernels.kernel(twice)
    monkeypatch.setattr(
        kernel_cache, 'write_kept', lambda *_: (_ for _ in ()).throw(OSError(28, 'full')))
    assert (compiled(3), compiled(1.5)) == (6, 3.0)
    line, = capsys.readouterr().err.splitlines()
    assert 'cannot be kept, full' in line


def test_a_directory_that_can_only_be_read_is_read(
        monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A root user writes everywhere, so that the refusal is played."""
    first, second = tmp_path / 'first' / 'isa_ros', tmp_path / 'second' / 'isa_ros'
    (first / 'kernels').mkdir(parents=True)
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(first.parent))
    monkeypatch.setenv('XDG_CACHE_HOME', str(second.parent))
    monkeypatch.setattr(
        kernel_directory.os, 'access', lambda path, mode: first not in (path, path.parent))
    assert cache_directories() == (
        second / 'kernels', (first / 'kernels', second / 'kernels'))


@pytest.mark.parametrize(('owner', 'mode', 'expected'), [
    (os.geteuid(), 0o700, True), (0, 0o755, True), (12_345, 0o700, False),
    (os.geteuid(), 0o702, False)])
def test_only_the_user_and_root_are_trusted(owner: int, mode: int, expected: bool) -> None:
    class Directory:
        def stat(self) -> os.stat_result:
            return os.stat_result((0o40000 | mode, 0, 0, 0, owner, 0, 0, 0, 0, 0))

    assert kernel_directory._is_trusted(Directory()) is expected  # type: ignore[arg-type]


def test_what_is_loaded_counts_as_used(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(kernels, 'CACHE', tmp_path)
    assert kernels.kernel(twice)(3) == 6
    path, = tmp_path.iterdir()
    for minutes, is_noted in ((9.0, False), (11.0, True)):
        used = time.time() - minutes * 60.0
        os.utime(path, (used, used))
        assert kernels.kernel(twice)(3) == 6
        assert (path.stat().st_mtime > used + 1.0) == is_noted


def test_other_processors_and_versions_are_other_files(monkeypatch: pytest.MonkeyPatch) -> None:
    class Codegen:
        def __init__(self, processor: str) -> None:
            self.processor = processor

        def magic_tuple(self) -> tuple[str, ...]:
            return 'x86_64', self.processor

    cache = kernels.kernel(twice)._cache
    types = (numba.int64,)
    first = cache._name(types, Codegen('skylake'))
    assert first != cache._name(types, Codegen('zen4'))
    monkeypatch.setattr(kernel_cache, 'environment', lambda: 'numba 99')
    assert first != cache._name(types, Codegen('skylake'))


LARGE = np.zeros(200_000)


def first_of(x):
    return LARGE[x]


def test_an_array_that_stays_outside_the_code_is_not_kept(
        monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Above 1 MB the code has its address, which is another one in another process."""
    monkeypatch.setattr(kernels, 'CACHE', tmp_path)
    assert kernels.kernel(first_of)(3) == 0.0
    assert not list(tmp_path.iterdir())


def test_a_kernel_is_kept_once_it_is_compiled(
        monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(kernels, 'CACHE', tmp_path)
    monkeypatch.setattr(kernel_directory, 'READ', (tmp_path,))
    one, other = kernels.kernel(twice), kernels.kernel(first_of)
    assert not is_kept(one)
    one(3)
    assert is_kept(one)
    assert not is_kept(other)
