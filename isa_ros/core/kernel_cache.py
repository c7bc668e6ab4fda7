"""
The directory in which compiled kernels are kept.

One file holds one kernel, compiled for one combination of argument types. Its name contains a
digest of all that the machine code depends on: the kernel and what it calls (`kernel_key`), the
argument types, the processor, and the versions of the compiler. So an edit compiles what depends
on it and nothing else, an edit taken back finds the old files until they are swept, and sources
at another path share the files.

numba's own cache does not notice an edit in another file, and finds kernels by the path of their
source.
"""

import contextlib
from functools import cache
import hashlib
from pathlib import Path
import pickle
import sys
from typing import Any

from isa_ros.core.kept_files import read_kept, write_kept
from isa_ros.core.kernel_directory import digest_text, READ
from isa_ros.core.kernel_key import is_unchanged
from isa_ros.core.kernel_library import SETTINGS
from isa_ros.core.value_text import type_text, UnknownValue
import llvmlite
from llvmlite.binding import parse_bitcode
import numba
from numba.core.caching import _Cache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import compile_result
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps
import numpy as np

_FORM = 2   # of a file; others are not read


@cache
def say_not_kept(reason: str) -> None:
    """Print one line, once in a process."""
    print(f'isa_ros: compiled kernels cannot be kept, {reason}: every start compiles them, for a '
          'minute or more; set NUMBA_CACHE_DIR to a directory of your own', file=sys.stderr)


@cache
def environment() -> str:
    """Return what all kernels depend on, besides the processor: versions and numba's settings."""
    settings: Any = numba.config
    return repr((sys.implementation.cache_tag, sys.version_info[:2], numba.__version__,
                 llvmlite.__version__, np.__version__.split('.')[:2],
                 [str(getattr(settings, name, None)) for name in SETTINGS]))


class _Library(JITCodeLibrary):
    """The machine code of a kept kernel; its bitcode is parsed when another kernel inlines it."""

    bitcode = b''

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None and self.bitcode:
            self._shared_module = parse_bitcode(self.bitcode)
        return super()._get_module_for_linking()  # type: ignore[no-untyped-call]


def _reduced(cres: Any) -> tuple[Any, ...]:
    """Return what is kept of a compiled version; inverse of `_rebuilt`."""
    (name, _, (code, bitcode)), fndesc, environment_, signature, *_, referenced = cres._reduce()
    module = cres.library._get_module_for_linking()
    defined = [value.name for values in (module.functions, module.global_variables)
               for value in values if not value.is_declaration]
    return name, code, bitcode, defined, fndesc, environment_, signature, referenced


def _rebuilt(context: Any, name: str, code: bytes, bitcode: bytes, defined: list[str],
             fndesc: Any, environment_: Any, signature: Any, referenced: Any) -> Any:
    """
    Return a compiled version, as numba's `CompileResult._rebuild` does, but for its bitcode.

    Parsing that takes longer than all else, and few kernels of a start are inlined.
    """
    codegen = context.codegen()
    library = _Library(codegen, name)  # type: ignore[no-untyped-call]
    library.bitcode = bitcode
    library.enable_object_caching()  # type: ignore[no-untyped-call]
    library._set_compiled_object(code)  # type: ignore[no-untyped-call]
    library._finalize_final_module()  # type: ignore[no-untyped-call]
    codegen._engine._defined_symbols.update(defined)
    for each in referenced:
        codegen.set_env(each.env_name, each)
    return compile_result(  # type: ignore[no-untyped-call]
        target_context=context, typing_context=context.typing_context, library=library,
        entry_point=context.get_executable(library, fndesc, environment_),
        environment=environment_, fndesc=fndesc, signature=signature, objectmode=False,
        lifted=(), type_annotation='', reload_init=(), referenced_envs=referenced)


class KernelCache(_Cache):
    """The compiled versions of one kernel, as numba asks for them."""

    def __init__(self, kernel: Any, write: Path | None, read: tuple[Path, ...]) -> None:
        """Note the kernel; functions that it calls may be defined later than it."""
        self._kernel, self._write, self._read = kernel, write, read

    @property
    def cache_path(self) -> str | None:
        """Return the directory."""
        return None if self._write is None else str(self._write)

    def enable(self) -> None:
        """Do nothing: it always is."""

    def disable(self) -> None:
        """Keep and load nothing from now on."""
        self._write, self._read = None, ()

    def flush(self) -> None:
        """Do nothing: a file that is out of date is never read."""

    def _name(self, sig: Any, codegen: Any) -> str:
        """Return the name of the file for a combination of argument types."""
        types = ','.join(map(type_text, getattr(sig, 'args', sig)))
        asked = f'{_FORM} {environment()} {codegen.magic_tuple()} {types}'
        function = self._kernel.py_func
        name = f'{function.__module__.rpartition(".")[2]}.{function.__qualname__}'
        return (f'{name.replace("<", "").replace(">", "")}-'
                f'{hashlib.sha256(asked.encode()).hexdigest()[:16]}-'
                f'{digest_text(self._kernel)}')

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """
        Return a compiled version, None if no file has it.

        numba's runtime is what machine code links to. Declaring all that kernels may call, and
        importing scipy for it, takes half of the processor time of a start; the compiler does
        it itself where no file has the version. No file has one that is not machine code.
        """
        rtsys.initialize(target_context)
        if not issubclass(target_context.codegen()._library_class, JITCodeLibrary):
            return None
        with contextlib.suppress(UnknownValue):     # not kept either
            name = self._name(sig, target_context.codegen())
            try:
                for directory in self._read:
                    kept = read_kept(directory / name)
                    if kept is not None:
                        return _rebuilt(target_context, *pickle.loads(kept))
            except Exception as error:  # of numba: the file is whole, and of this version
                say_not_kept(f'as loading them fails with {error!r}')
        return None

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Keep a compiled version, if it is what its name says."""
        if not isinstance(cres.library, JITCodeLibrary):
            return      # `isa_ros.core.lowering`
        if cres.library.has_dynamic_globals or cres.lifted:
            return
        if self._write is None:
            say_not_kept('no directory is writable')
            return
        try:
            if is_unchanged(self._kernel):
                path = self._write / self._name(sig, cres.codegen)
                write_kept(path, dumps(_reduced(cres)))  # type: ignore[no-untyped-call]
        except UnknownValue as error:
            say_not_kept(f'as {self._kernel.__name__} names a value of type {error}')
        except OSError as error:
            say_not_kept(error.strerror or str(error))


def cache_of(kernel: Any, directory: Path | None, read: tuple[Path, ...] = READ) -> KernelCache:
    """Return the cache of a kernel in a directory."""
    if directory is not None and directory not in read:
        read = (directory,)
    return KernelCache(kernel, directory, read)
