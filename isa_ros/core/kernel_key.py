"""
What a compiled kernel depends on, as a text that changes if and only if one of these does.

A kernel is the bytecode of its function without line numbers and docstrings, its default values,
and all that it names: the values of constants, wherever they are defined, the fields of types, and
the functions that it calls, with all that those name. numba reads the same, when it compiles.
"""

from collections.abc import Callable, Iterator
import dis
from enum import EnumMeta
import hashlib
import sys
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import llvmlite
import numba
from numba import types
from numba.core.dispatcher import Dispatcher
import numpy as np

_NAMED = frozenset(dis.opmap[name] for name in ('LOAD_GLOBAL', 'LOAD_NAME'))
_ATTRIBUTES = frozenset(dis.opmap[name] for name in ('LOAD_ATTR', 'LOAD_METHOD')
                        if name in dis.opmap)
_CONSTANTS = frozenset(dis.hasconst)
_NAMES = frozenset(dis.hasname)
_EXTENDED = dis.EXTENDED_ARG
_SKIPPED = frozenset(dis.opmap[name] for name in ('CACHE', 'NOP') if name in dis.opmap)
# The lowest bits of these arguments are flags.
_SHIFTS = {dis.opmap['LOAD_GLOBAL']: 1 if sys.version_info >= (3, 11) else 0,
           dis.opmap['LOAD_ATTR']: 1 if sys.version_info >= (3, 12) else 0}
_BY_NAME = frozenset(('builtins', 'llvmlite', 'math', 'numba', 'numpy', 'operator'))
_SETTINGS = ('BOUNDSCHECK', 'DEBUGINFO_DEFAULT', 'DISABLE_INTEL_SVML', 'FULL_TRACEBACKS',
             'LLVM_REFPRUNE_FLAGS', 'LLVM_REFPRUNE_PASS', 'LOOP_VECTORIZE', 'OPT', 'SLP_VECTORIZE')
_NOTHING = object()


class UnknownValue(Exception):
    """A kernel names something of which is not known what a compiler reads in it."""


def environment() -> str:
    """Return what all kernels depend on, beside the processor."""
    settings: Any = numba.config
    return repr((sys.implementation.cache_tag, sys.version_info[:2], numba.__version__,
                 llvmlite.__version__, np.__version__.split('.')[:2],
                 [str(getattr(settings, name, None)) for name in _SETTINGS]))


def _called(value: Any) -> Callable[..., Any] | None:
    """Return the plain function of a kernel or a function whose code matters."""
    if isinstance(value, Dispatcher):
        function: Callable[..., Any] = value.py_func
        return function
    if isinstance(value, FunctionType) and value.__module__.partition('.')[0] not in _BY_NAME:
        return value
    return None


def _dtype_text(dtype: np.dtype[Any]) -> str:
    """Return all of a dtype that a compiler sees."""
    if dtype.subdtype:
        return f'{_dtype_text(dtype.subdtype[0])}{dtype.subdtype[1]}'
    if dtype.fields is None:
        return dtype.str
    fields = ','.join(f'{name}:{dtype.fields[name][1]}:{_dtype_text(dtype.fields[name][0])}'
                      for name in dtype.names or ())
    return f'{{{fields};{dtype.itemsize};{dtype.alignment};{dtype.isalignedstruct}}}'


def _class_text(kind: type) -> str:
    """Return a class: its name, the fields of a tuple, the values of an enumeration."""
    if isinstance(kind, EnumMeta):
        values: dict[str, Any] = dict(kind.__members__)
        members = [f'{name}={value_text(member.value)}' for name, member in values.items()]
    else:
        members = list(getattr(kind, '_fields', ()))
    return f'class {kind.__module__}.{kind.__qualname__} {members}'


def value_text(value: Any) -> str:
    """Return a constant as a text, equal for equal constants only."""
    kind: Any = type(value)
    if value is None or value is _NOTHING or kind in (bool, int, float, complex, str, bytes):
        return f'{kind.__name__} {value!r}' if value is not _NOTHING else 'undefined'
    if isinstance(value, tuple | list | frozenset):
        parts = [value_text(part) for part in value]
        if isinstance(value, frozenset):
            parts.sort()
        return f'{_class_text(kind)}({",".join(parts)})'
    if isinstance(value, np.generic):
        return f'{_dtype_text(value.dtype)} {value.tobytes().hex()}'
    if isinstance(value, np.ndarray):
        return (f'array {_dtype_text(value.dtype)} {value.shape} {value.strides} '
                f'{hashlib.sha256(value.tobytes()).hexdigest()}')
    if isinstance(value, np.dtype):
        return f'dtype {_dtype_text(value)}'
    if isinstance(kind, EnumMeta):
        return f'{_class_text(kind)}.{value.name}'
    if isinstance(value, CodeType):
        return 'code ' + ';'.join(_code_texts(value, {}, []))
    function: Any = _called(value)
    if function is not None or isinstance(value, FunctionType):
        function = function or value
        return f'function {function.__module__}.{function.__qualname__}'
    if isinstance(value, type):
        return _class_text(value)
    if isinstance(value, types.Type):
        return type_text(value)
    if isinstance(value, BuiltinFunctionType | np.ufunc):
        return f'builtin {getattr(value, "__module__", "")}.{value.__name__}'
    if isinstance(value, ModuleType):
        return f'module {value.__name__}'
    raise UnknownValue(f'{kind.__module__}.{kind.__qualname__}')


def type_text(kind: Any) -> str:
    """Return one of numba's types; the names of most say all."""
    inner: Any = kind
    if isinstance(kind, types.BaseNamedTuple):
        return f'{_class_text(inner.instance_class)}({",".join(map(type_text, inner.types))})'
    if isinstance(kind, types.BaseTuple):
        return f'({",".join(map(type_text, inner.types))})'
    if isinstance(kind, types.Dispatcher | types.Function | types.Callable):
        raise UnknownValue(str(kind))
    return f'{type(kind).__name__} {kind.name}'


def _instructions(code: CodeType) -> Iterator[tuple[int, int]]:
    """Yield (operation, argument); the bytecode as it was compiled, not as it is run."""
    raw, extended = code.co_code, 0
    for operation, argument in zip(raw[::2], raw[1::2]):
        if operation == _EXTENDED:
            extended = (extended | argument) << 8
        elif operation not in _SKIPPED:
            yield operation, extended | argument
            extended = 0


def _code_texts(code: CodeType, names: dict[str, Any], found: list[Any]) -> list[str]:
    """Return what one code does; to ``found`` go the values of names, with their names."""
    texts = [f'{code.co_argcount},{code.co_posonlyargcount},{code.co_kwonlyargcount},'
             f'{code.co_flags & ~0x4000000}',    # not: whether it has a docstring
             ','.join(code.co_varnames + code.co_freevars + code.co_cellvars),
             getattr(code, 'co_exceptiontable', b'').hex()]
    owner: Any = None       # of which the next instruction may name an attribute
    for operation, argument in _instructions(code):
        before, owner = owner, None
        if operation in _CONSTANTS:
            texts.append(f'{operation} {value_text(code.co_consts[argument])}')
            if isinstance(code.co_consts[argument], CodeType):
                _code_texts(code.co_consts[argument], names, found)
        elif operation in _NAMES:
            name = code.co_names[argument >> _SHIFTS.get(operation, 0)]
            texts.append(f'{operation} {argument & _SHIFTS.get(operation, 0)} {name}')
            if operation in _NAMED:
                value = names.get(name, _NOTHING)
                found.append((name, value))
                owner = (name, value)
            elif operation in _ATTRIBUTES and before and isinstance(before[1], ModuleType):
                name = f'{before[0]}.{name}'
                value = getattr(before[1], name.rpartition('.')[2], _NOTHING)
                found.append((name, value))
                owner = (name, value)
        else:
            texts.append(f'{operation} {argument}')
    return texts


class _Own:
    """What one function is, without those it calls."""

    def __init__(self, function: Any, options: str) -> None:
        """Read the code and what it names."""
        found: list[tuple[Any, Any]] = []
        names = {**vars(sys.modules['builtins']), **function.__globals__}
        texts = _code_texts(function.__code__, names, found)
        cells = zip(function.__code__.co_freevars, function.__closure__ or ())
        found += [(name, cell.cell_contents) for name, cell in cells]
        found += enumerate(function.__defaults__ or ())
        found += sorted((function.__kwdefaults__ or {}).items())
        values = dict(found)
        self.calls: list[Any] = []
        for value in values.values():
            self.calls += [part for part in (value if type(value) in (tuple, list) else (value,))
                           if _called(part) is not None]
        texts += [f'{name} = {value_text(value)}' for name, value in values.items()]
        self.text = (f'{function.__module__}.{function.__qualname__} {options}\n'
                     + '\n'.join(texts)).encode()


_SEEN: dict[Any, _Own] = {}


def _own(function: Any, options: str, seen: dict[Any, _Own]) -> _Own:
    """Return what a function is, read once."""
    found = seen.get(function)
    if found is None:
        found = seen[function] = _Own(function, options)
    return found


def _options(value: Any) -> str:
    """Return the options a kernel is compiled with."""
    return repr(sorted(value.targetoptions.items())) if isinstance(value, Dispatcher) else ''


def _digest(kernel: Any, seen: dict[Any, _Own]) -> bytes:
    """Return the digest of a kernel and of all that it calls, directly or not."""
    reached, waiting = {}, [kernel]
    while waiting:
        value = waiting.pop()
        function = _called(value)
        if function not in reached:
            reached[function] = own = _own(function, _options(value), seen)
            waiting += reversed(own.calls)
    return hashlib.sha256(b'\0'.join(own.text for own in reached.values())).digest()


def kernel_digest(kernel: Any) -> bytes:
    """
    Return the digest of a kernel, with the values at the first look, which numba freezes too.

    Cycles of calls are harmless: it is the digest of the set of functions reached, in order.
    """
    return _digest(kernel, _SEEN)


def is_unchanged(kernel: Any, digest: bytes) -> bool:
    """Return whether no constant has got another value since: what was compiled may mix both."""
    return _digest(kernel, {}) == digest
