"""
Libraries of machine code of kernels: what a start loads instead of the compiler.

A library has a symbol for each kernel and kind of arguments that it was made for, named by the
digest of both: what was edited since is not found, and compiled. `scripts/make_kernels.py` makes
those that are shipped, one for each kind of processor.
"""

from collections.abc import Callable
import ctypes
from functools import cache
import hashlib
import json
import os
from pathlib import Path
import struct
from typing import Any, Protocol

from isa_ros.core import kernel_key
from isa_ros.core.kernel_key import file_digest, kernel_digest, source_digest
from isa_ros.core.kinds import (
    Kind, kind_of_form, kind_text, RESULT_WORDS, value_of, words_of)
from isa_ros.core.value_text import UnknownValue

SHIPPED = Path(__file__).parents[1] / 'kernels'
"""The directory of the libraries of this package."""
SETTINGS = ('BOUNDSCHECK', 'DEBUGINFO_DEFAULT', 'DISABLE_INTEL_SVML', 'FULL_TRACEBACKS',
            'LLVM_REFPRUNE_FLAGS', 'LLVM_REFPRUNE_PASS', 'LOOP_VECTORIZE', 'OPT', 'SLP_VECTORIZE')
"""Of numba, that change machine code: with one in the environment all kernels are compiled."""
MAKERS = 'compiler', 'kinds', 'lowering', 'object_runtime', 'objects', 'shortcuts', 'words'
"""Modules of this room that make machine code of entries: with another source all is made anew."""
_RESULT = '_result'     # behind a symbol, of the form of what the kernel returns
_RESULT_BYTES = RESULT_WORDS * ctypes.sizeof(ctypes.c_int64)
_CALLED = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)
_V3 = frozenset(('abm', 'avx2', 'bmi1', 'bmi2', 'f16c', 'fma', 'movbe'))
"""Flags of a processor whose machine code may be that of x86-64-v3, as Linux names them."""
_PROCESSOR = Path('/proc/cpuinfo')
_FIRST_BYTES = 8192     # with all of the first core


class NamedKernel(Protocol):
    """A kernel with the kinds its machine code is made for: `isa_ros.core.kernel.KernelEntry`."""

    @property
    def symbol(self) -> str:
        """Its name in a library, as `symbol_of` has it."""


@cache
def _table(n: int) -> tuple[type[ctypes.Array[ctypes.c_int64]], Callable[..., None]]:
    """Return what makes a table of results and ``n`` words, and what puts the words into it."""
    return ctypes.c_int64 * (RESULT_WORDS + n), struct.Struct(f'{n}q').pack_into


class Call:
    """Machine code of a kernel for one combination of kinds of arguments."""

    def __init__(self, address: int, result: Kind | None) -> None:
        self._called, self._result = _CALLED(address), result

    def __call__(self, arguments: tuple[Any, ...]) -> Any:
        """Run it and return what the kernel returns."""
        words = words_of(arguments)
        made, put = _table(len(words))
        table = made()
        put(table, _RESULT_BYTES, *words)
        self._called(table)
        return None if self._result is None else value_of(self._result, iter(table))


@cache
def _makers() -> str:
    """Return the digest of the sources that make entries of kernels."""
    own = Path(kernel_key.__file__)
    return ' '.join(file_digest(str(own.with_name(f'{name}.py'))) for name in MAKERS)


def symbol_of(kernel: Any, form: str, kind: Kind) -> str:
    """
    Return the name of the machine code of a kernel, as it is now, for arguments of a kind.

    Raises
    ------
    UnknownValue
        The kernel names a value that is not known, or a source is missing.

    """
    return f'{kernel.__name__}_{_digest_text(source_digest(kernel), form, kind)}'


def kept_symbol_of(kernel: Any, form: str, kind: Kind) -> str:
    """
    Return the name by which it is kept: other words around the same code leave it as it is.

    Raises
    ------
    UnknownValue
        The kernel names a value that is not known.

    """
    return f'{kernel.__name__}_{_digest_text(kernel_digest(kernel), form, kind)}'


def _digest_text(digest: bytes, form: str, kind: Kind) -> str:
    """Return the digest of a kernel, of what makes an entry of it, and of the entry's kind."""
    text = f'{_makers()} {form} {digest.hex()} {kind_text(kind)}'
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def result_symbol(symbol: str) -> str:
    """Return the name of the text, in JSON, that has the form of what a kernel returns."""
    return symbol + _RESULT


def own_targets() -> list[str]:
    """Return the names of the targets whose code runs on this machine, the fastest first."""
    machine = os.uname().machine
    if machine != 'x86_64':
        return [machine]
    with _PROCESSOR.open('rb') as file:
        words = file.read(_FIRST_BYTES).decode(errors='replace').split()
    return ['x86-64-v3'] * (_V3 <= set(words)) + ['x86-64']


def is_set_for_numba() -> bool:
    """Return whether the environment has a setting for which numba has to compile all kernels."""
    return any(f'NUMBA_{name}' in os.environ for name in SETTINGS)


def library_path() -> Path | None:
    """Return the fastest library that runs on this processor, None if there is none."""
    if is_set_for_numba():
        return None
    paths = (SHIPPED / f'{target}.so' for target in own_targets())
    return next(filter(Path.exists, paths), None)


@cache
def _library() -> ctypes.CDLL | None:
    """Load the library of this process, once."""
    path = library_path()
    return None if path is None else ctypes.CDLL(str(path))


def _found(entry: NamedKernel) -> tuple[ctypes.CDLL, str] | None:
    """Return the library that has an entry, and its symbol; None if there is none."""
    library = _library()
    if library is None:
        return None
    try:
        symbol = entry.symbol
        library[symbol]
    except (AttributeError, UnknownValue):
        return None
    return library, symbol


def address_in_library(entry: NamedKernel) -> int:
    """Return the address of an entry's machine code in a library, 0 if none has it."""
    found = _found(entry)
    return 0 if found is None else address_in(*found)


def address_in(library: ctypes.CDLL, symbol: str) -> int:
    """Return the address of the machine code that a library has by a name."""
    return ctypes.cast(library[symbol], ctypes.c_void_p).value or 0


def call_in_library(entry: NamedKernel) -> Callable[[tuple[Any, ...]], Any] | None:
    """Return what calls an entry's machine code with its arguments, None if no library has it."""
    found = _found(entry)
    return None if found is None else call_in(*found)


def call_in(library: ctypes.CDLL, symbol: str) -> Call:
    """Return what calls the machine code that a library has by a name with its arguments."""
    form = ctypes.string_at(ctypes.addressof(
        ctypes.c_char.in_dll(library, result_symbol(symbol)))).decode()
    return Call(address_in(library, symbol), kind_of_form(json.loads(form)))
