"""
Libraries of machine code of kernels: what a start loads instead of the compiler.

A library has a symbol for each kernel and kind of arguments that it was made for, named by the
digest of both: what was edited since is not found, and compiled. `scripts/make_kernels.py` makes
those that are shipped, one for each kind of processor.
"""

from collections.abc import Callable, Sequence
import ctypes
from functools import cache
import hashlib
import os
from pathlib import Path
import struct
from typing import Any

from isa_ros.core.kernel_key import kernel_digest, UnknownValue
from isa_ros.core.kinds import Kind, kind_text, NOTHING, ONE, RESULT_WORDS, words_of

SHIPPED = Path(__file__).parents[1] / 'kernels'
"""The directory of the libraries of this package."""
_FORM = 1       # of the words of arguments and results
_CALLED = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)
_FLOAT, _WORD = struct.Struct('d'), struct.Struct('q')
_READ: tuple[Callable[[int], Any], ...] = (
    int, lambda word: word % (1 << 64), lambda word: _FLOAT.unpack(_WORD.pack(word))[0], bool)


_V3 = frozenset(('abm', 'avx2', 'bmi1', 'bmi2', 'f16c', 'fma', 'movbe'))
"""Flags of a processor whose machine code may be that of x86-64-v3, as Linux names them."""
_PROCESSOR = Path('/proc/cpuinfo')
_FIRST_BYTES = 8192     # with all of the first core


class Call:
    """Machine code of a kernel for one combination of kinds of arguments."""

    def __init__(self, address: int) -> None:
        self._called = _CALLED(address)

    def __call__(self, arguments: Sequence[Any]) -> Any:
        """Run it and return what the kernel returns."""
        words = [0] * RESULT_WORDS
        words.extend(words_of(tuple(arguments)))
        table = (ctypes.c_int64 * len(words))(*words)
        self._called(table)
        count = table[0]
        if count == NOTHING:
            return None
        values = [_READ[table[k]](table[k + 1]) for k in range(1, 1 + 2 * abs(count), 2)]
        return values[0] if count == ONE else tuple(values)


def symbol_of(kernel: Any, form: str, kind: Kind) -> str:
    """
    Return the name of the machine code of a kernel, as it is now, for arguments of a kind.

    Raises
    ------
    UnknownValue
        The kernel names a value that is not known.

    """
    text = f'{_FORM} {form} {kernel_digest(kernel).hex()} {kind_text(kind)}'
    return f'{kernel.__name__}_{hashlib.sha256(text.encode()).hexdigest()[:32]}'


def own_targets() -> list[str]:
    """Return the names of the targets whose code runs on this machine, the fastest first."""
    machine = os.uname().machine
    if machine != 'x86_64':
        return [machine]
    with _PROCESSOR.open('rb') as file:
        words = file.read(_FIRST_BYTES).decode(errors='replace').split()
    return ['x86-64-v3'] * (_V3 <= set(words)) + ['x86-64']


@cache
def _libraries() -> tuple[ctypes.CDLL, ...]:
    """Load the fastest library of this package that runs on this processor, if there is one."""
    paths = [SHIPPED / f'{target}.so' for target in own_targets()]
    return tuple(ctypes.CDLL(str(path)) for path in paths[:1] if path.exists())


def address_in_library(symbol: Callable[[], str]) -> int:
    """Return the address of what a symbol names in a library, 0 if none has it."""
    for library in _libraries():
        try:
            found = library[symbol()]
        except (AttributeError, UnknownValue):
            continue
        return ctypes.cast(found, ctypes.c_void_p).value or 0
    return 0
