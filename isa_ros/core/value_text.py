"""
What the compiler reads of a function and of the values that it names, as texts.

Texts are equal for equal values only. Of bytecode, line numbers, docstrings and paths are left
out.
"""

from collections.abc import Iterator
import dis
from enum import EnumMeta
import sys
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

# What is left out of bytecode: places for the interpreter's notes, and what -OO leaves of asserts.
_SKIPPED = frozenset(dis.opmap[name] for name in ('CACHE', 'NOP') if name in dis.opmap)
_HAS_CONSTANT, _HAS_NAME = frozenset(dis.hasconst), frozenset(dis.hasname)
_LOAD_GLOBAL = dis.opmap['LOAD_GLOBAL']
_LOAD_ATTRIBUTE = frozenset(
    dis.opmap[name] for name in ('LOAD_ATTR', 'LOAD_METHOD') if name in dis.opmap)
# The lowest bit of these arguments is a flag; above it is the index of a name.
_FLAGGED = {_LOAD_GLOBAL: sys.version_info >= (3, 11),
            dis.opmap['LOAD_ATTR']: sys.version_info >= (3, 12)}
_HAS_DOCSTRING = 0x4000000      # a flag of code, of Python 3.13 and later
_BY_NAME = frozenset(('builtins', 'llvmlite', 'math', 'numba', 'numpy', 'operator'))
"""Packages of which a name says all: their versions are in the name of a kept kernel."""
_CALLED = (FunctionType, BuiltinFunctionType, np.ufunc)


class UnknownValue(Exception):
    """A kernel names a value of a type of which it is not known what the compiler reads."""


def _of_compiler(module: str, name: str) -> Any:
    """Return a class of numba; while that is not loaded no value is of it, nor of ()."""
    return getattr(sys.modules.get(module), name, ())


def is_kernel(value: Any) -> bool:
    """Return whether a value is a kernel, of this package or of numba itself."""
    return not isinstance(value, type) and hasattr(value, 'py_func')


def function_of(value: Any) -> Any:
    """Return the Python function of a kernel or function whose code matters, None for others."""
    if is_kernel(value):
        return value.py_func
    if hasattr(value, '_defn'):     # of the compiler
        return value._defn
    is_own = isinstance(value, FunctionType) and _package(value) not in _BY_NAME
    return value if is_own else None


def _package(function: Any) -> str:
    """Return the package that defines a function."""
    package: str = (function.__module__ or '').partition('.')[0]
    return package


def dtype_text(dtype: np.dtype[Any]) -> str:
    """Return all of a dtype that the compiler reads."""
    if dtype.subdtype:
        return f'{dtype_text(dtype.subdtype[0])}{dtype.subdtype[1]}'
    if dtype.fields is None:
        return dtype.str
    fields = ','.join(f'{name}:{dtype.fields[name][1]}:{dtype_text(dtype.fields[name][0])}'
                      for name in dtype.names or ())
    return f'{{{fields};{dtype.itemsize};{dtype.alignment};{dtype.isalignedstruct}}}'


def class_text(kind: type) -> str:
    """Return a class: its name, the fields of a tuple, the values of an enumeration."""
    if isinstance(kind, EnumMeta):
        members: dict[str, Any] = dict(kind.__members__)
        parts = [f'{name}={value_text(member.value)}' for name, member in members.items()]
    else:
        parts = list(getattr(kind, '_fields', ()))
    return f'class {kind.__module__}.{kind.__qualname__} {parts}'


def value_text(value: Any) -> str:
    """
    Return a constant as a text, equal for equal constants only.

    Functions and modules are named here; `isa_ros.core.kernel_key` follows the functions.

    Raises
    ------
    UnknownValue
        It is not known what the compiler reads of such a value.

    """
    kind: Any = type(value)
    if value is Any:
        return 'Any'
    if value is None or kind in (bool, int, float, complex, str, bytes):
        return f'{kind.__name__} {value!r}'
    if isinstance(value, tuple):
        return f'{class_text(kind)}({",".join(map(value_text, value))})'
    if isinstance(value, frozenset):
        return f'{class_text(kind)}({",".join(sorted(map(value_text, value)))})'
    if isinstance(value, np.generic | np.ndarray):
        return f'{dtype_text(value.dtype)} {value.shape} {value.strides} {value.tobytes().hex()}'
    if isinstance(value, np.dtype):
        return f'dtype {dtype_text(value)}'
    if isinstance(kind, EnumMeta):
        return f'{class_text(kind)}.{value.name}'
    if isinstance(value, CodeType):
        return f'code {code_text(value)}'
    if isinstance(value, type):
        return class_text(value)
    if isinstance(value, _of_compiler('numba.core.types', 'Type')):
        return type_text(value)
    function: Any = function_of(value)
    if function is not None or isinstance(value, _CALLED):
        function = function or value
        return (f'function {getattr(function, "__module__", "")}.'
                f'{getattr(function, "__qualname__", function.__name__)}')
    if isinstance(value, ModuleType):
        return f'module {value.__name__}'
    raise UnknownValue(f'{kind.__module__}.{kind.__qualname__}')


def type_text(kind: Any) -> str:
    """Return numba's type of an argument; the names of most of them say all."""
    from numba import types     # a value of its types has loaded it
    inner: Any = kind
    if isinstance(kind, types.BaseNamedTuple):
        return f'{class_text(inner.instance_class)}({",".join(map(type_text, inner.types))})'
    if isinstance(kind, types.BaseTuple):
        return f'({",".join(map(type_text, inner.types))})'
    if isinstance(kind, types.Dispatcher | types.Function | types.Callable):
        raise UnknownValue(str(kind))
    return f'{type(kind).__name__} {kind.name}'


def _instructions(code: CodeType) -> list[tuple[int, int]]:
    """Return (operation, argument) of the bytecode, an extended argument put together."""
    found, extended = [], 0
    for operation, argument in zip(code.co_code[::2], code.co_code[1::2]):
        if operation in _SKIPPED:
            continue
        if operation == dis.EXTENDED_ARG:
            extended = (extended | argument) << 8
        else:
            found.append((operation, extended | argument))
            extended = 0
    return found


def _name_in(code: CodeType, operation: int, argument: int) -> str:
    """Return the name that an instruction reads."""
    return code.co_names[argument >> _FLAGGED.get(operation, 0)]


def code_text(code: CodeType) -> str:
    """Return what code does, with constants and names in the place of their indices."""
    texts = [f'{code.co_argcount},{code.co_posonlyargcount},{code.co_kwonlyargcount},'
             f'{code.co_flags & ~_HAS_DOCSTRING}',
             ','.join(code.co_varnames + code.co_freevars + code.co_cellvars),
             getattr(code, 'co_exceptiontable', b'').hex()]
    for operation, argument in _instructions(code):
        if operation in _HAS_CONSTANT:
            what = value_text(code.co_consts[argument])
        elif operation in _HAS_NAME:
            flag = argument & _FLAGGED.get(operation, 0)
            what = f'{flag} {_name_in(code, operation, argument)}'
        else:
            what = str(argument)
        texts.append(f'{operation} {what}')
    return '\n'.join(texts)


def named(code: CodeType, names: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield what code and the functions defined in it name, with the attributes of modules."""
    owner, value = '', None     # a name, and what it stands for if the last instruction read it
    for operation, argument in _instructions(code):
        is_attribute = operation in _LOAD_ATTRIBUTE and isinstance(value, ModuleType)
        if operation == _LOAD_GLOBAL or is_attribute:
            name = _name_in(code, operation, argument)
            value = getattr(value, name, None) if is_attribute else names.get(name)
            owner = f'{owner}.{name}' if is_attribute else name
            yield owner, value
        else:
            value = None
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from named(constant, names)


def is_foreign(value: Any) -> bool:
    """Return whether a value is a function of another package: its name says all."""
    return isinstance(value, _CALLED) and function_of(value) is None
