"""
The first run of an installed wheel, which brings its kernels.

The wheel is made from this checkout as a release is, with the libraries of kernels for this
processor, and installed in an environment of its own, which takes what the wheel needs from this
Python's; the run, the leg's drop for a tenth of a second, finds no compiled kernels but those of
the wheel.
"""

import os
from pathlib import Path
import resource
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import venv

from isa_ros.bench.child import last_line, ROOT
from isa_ros.bench.row import Aim, Row
from isa_ros.errors import RunError

TIMEOUT_S = 900.0
AIM = Aim(6.0, is_most=True)
RUN = ('bringup', 'leg', '--scenario', 'drop', '--duration', '0.1')
MIB = 1024.0 * 1024.0


def missing(is_wanted: bool) -> str:
    """Return why the first run is not measured; '' if it is."""
    if not is_wanted:
        return 'needs --first-run: it compiles all kernels and makes a wheel'
    return '' if (ROOT / 'setup.py').is_file() else f'needs a checkout, {ROOT} has no setup.py'


def first_run_rows() -> list[Row]:
    """
    Return the processor time of a first and of a second run, and the size of the wheel.

    Raises
    ------
    RunError
        The wheel cannot be made or installed, or a run failed.

    """
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        place = Path(directory)
        wheel = _wheel(place)
        python = _installed(wheel, place / 'environment')
        first, of_host = _spent(place, python, 'first')
        second, _ = _spent(place, python, 'second')
        size = wheel.stat().st_size / MIB
    row = Row('first run of an installed wheel, processor time', first, 's').aiming(AIM)
    if row.is_reached is False:
        row = row.noting(f'{of_host:.1f} s of host time; the second run {second:.1f} s')
    return [row, *(part.under(row) for part in (
        Row('its host time', of_host, 's'), Row('the second run, processor time', second, 's'),
        Row('the wheel', size, 'MiB')))]


def _wheel(place: Path) -> Path:
    """Make the wheel of this checkout in a directory, its kernels before, and return its path."""
    source = place / 'source'   # setuptools leaves files where it builds
    shutil.copytree(ROOT, source, ignore=_unneeded)
    _make_kernels(source, place)
    _pip('wheel', '--no-deps', '--no-build-isolation', '--wheel-dir', str(place), str(source))
    wheel, = place.glob('*.whl')
    return wheel


def _make_kernels(source: Path, place: Path) -> None:
    """Make the libraries of kernels of a checkout for this processor."""
    ended = subprocess.run(
        [sys.executable, '-m', 'scripts.make_kernels'], cwd=source,
        env=_environment(place / 'maker'), stdin=subprocess.DEVNULL, capture_output=True,
        text=True, timeout=TIMEOUT_S)
    if ended.returncode:
        raise RunError(f'kernels of the wheel: {last_line(ended)}')


def _unneeded(folder: str, names: list[str]) -> set[str]:
    """Return what of a folder of this checkout a wheel does not need."""
    found = {name for name in names if name.startswith('.') or name == '__pycache__'}
    if Path(folder) == ROOT:
        found.update(name for name in names if name in ('build', 'runs', 'tests', 'docs')
                     or name.endswith('.egg-info'))
    if Path(folder) == ROOT / 'isa_ros':
        found.add('kernels')    # they are made anew
    return found


def _installed(wheel: Path, environment: Path) -> Path:
    """Install the wheel in a new environment and return its Python."""
    venv.create(environment)
    python = environment / 'bin' / 'python'
    _pip('--python', str(python), 'install', '--no-deps', '--no-compile', str(wheel))
    own = Path(sysconfig.get_path('purelib'))
    (environment / own.relative_to(sys.prefix) / 'needed.pth').write_text(
        f'{own}\n', encoding='utf-8')
    return python


def _pip(*arguments: str) -> None:
    ended = subprocess.run(
        [sys.executable, '-m', 'pip', '--quiet', '--disable-pip-version-check', *arguments],
        env=_without('PYTHONPATH'),     # pip leaves out a package that it finds there
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=TIMEOUT_S)
    if ended.returncode:
        raise RunError(f'pip of the first run: {last_line(ended)}')


def _spent(place: Path, python: Path, name: str) -> tuple[float, float]:
    """Return processor time and host time of a run with the kernels kept in ``place``, s."""
    before, begun = _of_children(), time.monotonic()
    ended = subprocess.run(
        [str(python), '-m', 'isa_ros', *RUN, '--out', str(place / name)], cwd=place,
        env=_environment(place), stdin=subprocess.DEVNULL, capture_output=True, text=True,
        timeout=TIMEOUT_S)
    if ended.returncode:
        raise RunError(f'the {name} run of the wheel: {last_line(ended)}')
    return _of_children() - before, time.monotonic() - begun


def _environment(place: Path) -> dict[str, str]:
    """Return the environment of a user who has the wheel and no compiled kernels."""
    return _without('NUMBA_CACHE_DIR', 'PYTHONPATH') | {
        'XDG_CACHE_HOME': str(place / 'cache'), 'HOME': str(place), 'PYTHONDONTWRITEBYTECODE': '1'}


def _without(*names: str) -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name not in names}


def _of_children() -> float:
    """Return the processor time of all ended children of this process and theirs, s."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime
