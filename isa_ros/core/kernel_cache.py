"""
The directory in which compiled kernels are kept.

One file is one kernel for one combination of argument types. Its name holds a digest of all that
the machine code depends on: the kernel and what it calls (`kernel_key`), the argument types, the
processor, and the versions of the compiler. So an edit compiles what depends on it, again if it is
taken back only when the old file has been swept, and sources at another path share the files.

No lock is needed: a file is written aside and put in place at once, and two processes that
compile the same kernel write the same. numba's own cache has one index for all types of a kernel,
which two writers damage, and does not see an edit in another file.
"""

from collections.abc import Iterator
import contextlib
from functools import cache
import hashlib
import os
from pathlib import Path
import pickle
import stat
import sys
import tempfile
import time
from typing import Any

from isa_ros.core.kernel_key import (
    environment, is_unchanged, kernel_digest, type_text, UnknownValue)
from llvmlite.binding import parse_bitcode
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

_FORM = 1
_DAY = 86400.0
_KEPT_DAYS, _KEPT_BYTES = 30, 256 << 20


def _candidates() -> Iterator[Path]:
    """Yield the directories that may hold the caches of all versions, the preferred one first."""
    for variable in ('NUMBA_CACHE_DIR', 'XDG_CACHE_HOME'):
        if os.environ.get(variable):
            yield Path(os.environ[variable]).absolute() / 'isa_ros'
    with contextlib.suppress(RuntimeError):  # no HOME, and a user without an entry in passwd
        yield Path.home() / '.cache' / 'isa_ros'
    with contextlib.suppress(FileNotFoundError):  # no temporary directory either
        yield Path(tempfile.gettempdir()) / f'isa_ros-{os.geteuid()}'


def _is_trusted(directory: Path) -> bool:
    """Return whether nobody else may put code there that is run."""
    try:
        found = directory.stat()
    except OSError:
        return False
    return found.st_uid in (0, os.geteuid()) and not found.st_mode & stat.S_IWOTH


def _is_own(directory: Path) -> bool:
    """Return whether a directory can be written, and is trusted; it is made if need be."""
    with contextlib.suppress(OSError):
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    return _is_trusted(directory) and os.access(directory, os.W_OK | os.X_OK)


def cache_directories() -> tuple[Path | None, tuple[Path, ...]]:
    """Return the directory to write to, None if there is none, and all to read from."""
    readable: list[Path] = []
    for directory in _candidates():
        place = directory / 'kernels'
        if _is_own(directory) and _is_own(place):
            return place, (*readable, place)
        if _is_trusted(directory) and _is_trusted(place):
            readable.append(place)
    return None, tuple(readable)


CACHE, _READ = cache_directories()
"""The directory of kernels; None: those that no readable one holds are compiled every time."""


@cache
def _say_not_kept(reason: str) -> None:
    """Print one line, once in a process."""
    print(f'isa_ros: compiled kernels cannot be kept, {reason}: every start compiles them, for a '
          'minute or more; set NUMBA_CACHE_DIR to a directory of your own', file=sys.stderr)


@cache
def _environment() -> str:
    """Return the compiler's versions, read once."""
    return environment()


def _check(name: str, body: bytes | memoryview) -> bytes:
    """Return what tells a damaged or renamed file."""
    check = hashlib.blake2b(name.encode(), digest_size=16)
    check.update(body)
    return check.digest()


def _read(path: Path) -> Any:
    """Return what a file holds, None if there is none or it is damaged."""
    try:
        with path.open('rb') as file:
            used = os.fstat(file.fileno()).st_mtime
            data = file.read()
    except OSError:
        return None
    body = memoryview(data)[16:]
    if _check(path.name, body) != data[:16]:
        return None
    if time.time() - used > _DAY:
        with contextlib.suppress(OSError):
            os.utime(path)      # the sweep goes by it
    return pickle.loads(body)


def _write(path: Path, reduced: Any) -> None:
    """Write a file aside and put it in place."""
    body: bytes = dumps(reduced)  # type: ignore[no-untyped-call]
    handle, aside = tempfile.mkstemp(prefix='.', suffix='.part', dir=path.parent)
    try:
        with os.fdopen(handle, 'wb') as file:
            file.write(_check(path.name, body) + body)
        os.replace(aside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(aside)
        raise


@cache
def _sweep(directory: Path) -> None:
    """Delete, once in a process, what nobody has read for long, and old files beyond a size."""
    found = []
    for path in [*directory.iterdir(), *directory.parent.glob('[0-9a-f]' * 16 + '/*/*.nb[ci]')]:
        with contextlib.suppress(OSError):
            status = path.stat()
            found.append((status.st_mtime, status.st_size, path))
    oldest, size = time.time() - _KEPT_DAYS * _DAY, 0
    for used, more, path in sorted(found, reverse=True):
        size += more
        if used < oldest or size > _KEPT_BYTES:
            with contextlib.suppress(OSError):
                path.unlink()


def _reduced(cres: Any) -> tuple[Any, ...]:
    """Return what is written: without the text of types, and with the names that it defines."""
    (name, _, (code, bitcode)), *middle = cres._reduce()
    middle[5] = ''
    defined = [value.name for value in _values(cres.library._get_module_for_linking())
               if not value.is_declaration]
    return name, code, bitcode, defined, middle


def _values(module: Any) -> Iterator[Any]:
    """Yield the functions and variables of a module."""
    yield from module.functions
    yield from module.global_variables


def _rebuilt(context: Any, name: str, code: bytes, bitcode: bytes, defined: list[str],
             middle: list[Any]) -> Any:
    """
    Return a compiled version, as numba does, but for its bitcode.

    Only a kernel that inlines it needs that, and parsing it is most of the time of loading.
    """
    codegen = context.codegen()
    library = codegen.create_library(name)
    library.enable_object_caching()
    library._set_compiled_object(code)
    library._finalize_final_module()
    codegen._engine._defined_symbols.update(defined)

    def module_for_linking() -> Any:
        if library._shared_module is None:
            library._shared_module = parse_bitcode(bitcode)
        return library._shared_module

    library._get_module_for_linking = module_for_linking

    class _Codegen:
        """Hands the library to numba's way of building the rest."""

        @staticmethod
        def unserialize_library(_: Any) -> Any:
            return library

    class _Context:
        """The target context, with this library."""

        typing_context = context.typing_context

        def codegen(self) -> Any:
            return _Codegen

        def get_executable(self, *arguments: Any) -> Any:
            return context.get_executable(*arguments)

    found = CompileResult._rebuild(_Context(), None, *middle)  # type: ignore[no-untyped-call]
    return found._replace(target_context=context)


class KernelCache(_Cache):
    """What numba asks for the compiled versions of one kernel."""

    def __init__(self, kernel: Any, write: Path | None, read: tuple[Path, ...]) -> None:
        """Look at nothing yet: what the kernel names may not be defined."""
        self._kernel, self._write, self._read = kernel, write, read

    @property
    def cache_path(self) -> str | None:
        """Return the directory."""
        return None if self._write is None else str(self._write)

    def enable(self) -> None:
        """Do nothing: it is."""

    def disable(self) -> None:
        """Keep and load nothing from now on."""
        self._write, self._read = None, ()

    def flush(self) -> None:
        """Do nothing: what is stale is never read."""

    def name_of(self, sig: Any, codegen: Any) -> str:
        """Return the name of the file for a combination of argument types."""
        args = getattr(sig, 'args', sig)
        asked = (f'{_FORM} {_environment()} {codegen.magic_tuple()} '
                 f'{",".join(map(type_text, args))}')
        function = self._kernel.py_func
        return (f'{function.__module__.rpartition(".")[2]}.{function.__qualname__}-'
                f'{hashlib.sha256(asked.encode()).hexdigest()[:16]}-'
                f'{kernel_digest(self._kernel).hex()[:32]}').replace('<', '').replace('>', '')

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return a compiled version, None if there is none that can be read."""
        target_context.refresh()
        try:
            name = self.name_of(sig, target_context.codegen())
        except UnknownValue:
            return None
        for directory in self._read:
            with contextlib.suppress(Exception):     # damaged in whatever way: it is compiled
                reduced = _read(directory / name)
                if reduced is not None:
                    return _rebuilt(target_context, *reduced)
        return None

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Save one compiled version."""
        if cres.library.has_dynamic_globals or cres.lifted:
            return
        if self._write is None:
            _say_not_kept('no directory is writable')
            return
        try:
            if not is_unchanged(self._kernel, kernel_digest(self._kernel)):
                return
            path = self._write / self.name_of(sig, cres.codegen)
            self._write.mkdir(mode=0o700, parents=True, exist_ok=True)
            _write(path, _reduced(cres))
            _sweep(self._write)
        except UnknownValue as error:
            _say_not_kept(f'as {self._kernel.__name__} names a value of type {error}')
        except OSError as error:
            _say_not_kept(error.strerror or str(error))


def cache_of(kernel: Any, directory: Path | None, read: tuple[Path, ...] = _READ) -> KernelCache:
    """Return the cache of a kernel in a directory."""
    if directory is not None and directory not in read:
        read = (directory,)
    return KernelCache(kernel, directory, read)
