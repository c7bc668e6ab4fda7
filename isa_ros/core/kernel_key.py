"""
The digest of a kernel: it changes if and only if something changes that the kernel depends on.

A kernel depends on the bytecode of its function, its default values, and all that it names: the
values of constants, in whatever module they are defined, the fields of types, and the functions
that it calls, with all that those name in turn. Line numbers, docstrings and paths are left out.
numba reads the same when it compiles.

`source_digest` has the text of the source file in the place of the bytecode, which each minor
version of Python writes in its own way: by it kernels are found that another one has compiled. It
changes with every edit in a file of which a kernel is reached.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import cache
import hashlib
from pathlib import Path
import sys
from typing import Any, NamedTuple

from isa_ros.core.value_text import (
    code_text, function_of, is_foreign, is_kernel, named, UnknownValue, value_text)


class _Function(NamedTuple):
    """One function: its own text, and the functions that it names."""

    text: bytes
    calls: list[Any]


class _Reached(NamedTuple):
    """A kernel or function that a kernel reaches, and its own text."""

    value: Any
    text: bytes


def _values(function: Any) -> list[tuple[Any, Any]]:
    """Return the names of what a function names or has as defaults, and the values."""
    code = function.__code__
    names = {**vars(sys.modules['builtins']), **function.__globals__}
    return [*named(code, names),
            *zip(code.co_freevars, (cell.cell_contents for cell in function.__closure__ or ())),
            *enumerate(function.__defaults__ or ()),
            *sorted((function.__kwdefaults__ or {}).items())]


def _read(function: Any, options: str) -> _Function:
    """Read the bytecode of a function and what it names."""
    values = _values(function)
    texts = [f'{function.__module__}.{function.__qualname__} {options}',
             code_text(function.__code__),
             *dict.fromkeys(f'{name} = {value_text(value)}' for name, value in values)]
    return _Function('\n'.join(texts).encode(), list(_functions(value for _, value in values)))


@cache
def file_digest(path: str) -> str:
    """
    Return the digest of a source file.

    Raises
    ------
    UnknownValue
        It cannot be read.

    """
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError as error:
        raise UnknownValue(f'source {path}') from error


@cache
def _read_source(function: Any, options: str) -> _Function:
    """Read the source file of a function and what it names, whatever the order."""
    values = _values(function)
    code = function.__code__
    texts = [f'{function.__module__}.{function.__qualname__} {options}',
             f'{file_digest(code.co_filename)} {code.co_firstlineno}',
             *sorted({f'{name} = {"" if is_foreign(value) else value_text(value)}'
                      for name, value in values})]
    return _Function(hashlib.sha256('\n'.join(texts).encode()).digest(),
                     list(_functions(value for _, value in values)))


def _functions(values: Iterable[Any]) -> Iterator[Any]:
    """Yield the kernels and functions among values, and in tuples among them."""
    for value in values:
        if isinstance(value, tuple):
            yield from _functions(value)
        elif function_of(value) is not None:
            yield value


_read_once = cache(_read)


def _reached(
        kernels: Iterable[Any], read: Callable[[Any, str], _Function]) -> dict[Any, _Reached]:
    """Return the functions that kernels reach, in the order of finding them."""
    reached: dict[Any, _Reached] = {}   # so that calls in a circle end
    waiting = list(kernels)
    while waiting:
        value = waiting.pop()
        function = function_of(value)
        if function not in reached:
            options = repr(sorted(value.targetoptions.items())) if is_kernel(value) else ''
            text, calls = read(function, options)
            reached[function] = _Reached(value, text)
            waiting += reversed(calls)
    return reached


def _digest(kernels: Iterable[Any], read: Callable[[Any, str], _Function]) -> bytes:
    """Return the digest of the functions that kernels reach."""
    texts = (own.text for own in _reached(kernels, read).values())
    return hashlib.sha256(b'\0'.join(texts)).digest()


def kernels_of(*kernels: Any) -> list[Any]:
    """
    Return kernels and all that they call, each once.

    Raises
    ------
    UnknownValue
        One names a value that is not known.

    """
    return [own.value for own in _reached(kernels, _read_once).values()
            if is_kernel(own.value)]


def functions_of(kernel: Any) -> list[Any]:
    """
    Return the functions of a kernel and of all that it calls, each once.

    Raises
    ------
    UnknownValue
        One names a value that is not known.

    """
    return list(_reached([kernel], _read_once))


def digest_of(kernels: Iterable[Any]) -> bytes:
    """Return one digest of several kernels, with the values that each named at first sight."""
    return _digest(kernels, _read_once)


def source_digest(kernel: Any) -> bytes:
    """
    Return the digest of one kernel by source files, the same on every Python.

    Raises
    ------
    UnknownValue
        It names a value that is not known, or a source file is missing.

    """
    return hashlib.sha256(b''.join(sorted(
        own.text for own in _reached([kernel], _read_source).values()))).digest()


def kernel_digest(kernel: Any) -> bytes:
    """Return the digest of one kernel."""
    return digest_of([kernel])


def is_unchanged(kernel: Any) -> bool:
    """Return whether all values are those at first sight: compiled code may mix old and new."""
    return _digest([kernel], _read) == kernel_digest(kernel)
