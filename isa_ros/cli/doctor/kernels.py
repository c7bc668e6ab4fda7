"""The compiled kernels: where they are kept, how many there are, and the compilers."""

from collections.abc import Iterator
from pathlib import Path
import shutil

from isa_ros.cli.doctor.finding import Finding, Verdict
from isa_ros.cli.doctor.limits import in_megabytes

C_COMPILER = 'cc'
_GROUP = 'kernels'


def kernels() -> Iterator[Finding]:
    """Yield the library, the state of the cache, and the compiler of C."""
    from isa_ros.core.kernel_directory import CACHE
    from isa_ros.core.kernel_library import library_path
    yield loaded_from(library_path())
    yield kept_in(CACHE)
    found = shutil.which(C_COMPILER)
    yield Finding(_GROUP, C_COMPILER, found) if found else Finding(
        _GROUP, C_COMPILER, 'missing', Verdict.NOTE,
        'only for libraries of kernels: apt install gcc')


def loaded_from(library: Path | None) -> Finding:
    """Return the library of compiled kernels that starts load."""
    if library is None:
        return Finding(_GROUP, 'library', 'none', Verdict.NOTE,
                       'starts load numba; in a checkout: python -m scripts.make_kernels')
    return Finding(_GROUP, 'library', f'{library}, {in_megabytes(library.stat().st_size)}')


def kept_in(directory: Path | None) -> Finding:
    """Return the number of files in a cache, and their size."""
    if directory is None:
        return Finding(
            _GROUP, 'cache', 'no directory that can be written', Verdict.PROBLEM,
            'every start compiles for a minute or more: set NUMBA_CACHE_DIR to one of your own')
    files = [path.stat().st_size for path in directory.iterdir() if path.is_file()]
    if not files:
        return Finding(_GROUP, 'cache', f'{directory}, empty', Verdict.NOTE,
                       'the first run compiles its kernels, once')
    return Finding(
        _GROUP, 'cache', f'{directory}, {len(files)} files, {in_megabytes(sum(files))}')
