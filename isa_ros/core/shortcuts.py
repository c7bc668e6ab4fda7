"""
Shortcuts through numba: what its compiler does many times over for one kernel is done once.

Each stands in the place of a function of numba, gives the same instructions of LLVM and takes a
fraction of its time. It is taken only where numba's own source is the one that it was written
for: another version of numba compiles as it always does, only slower.
"""

from collections.abc import Callable, Iterable
import copy
import hashlib
import inspect
from typing import Any, NamedTuple

from llvmlite.ir.types import Type as LLVMType
from numba.core import ir
from numba.core.base import BaseContext
from numba.core.types import Record
from numba.core.types.functions import BaseFunction


class Shortcut(NamedTuple):
    """What stands in the place of a function of numba."""

    owner: Any
    name: str
    digest: str
    """Of the source of numba's function, `digest_of_source`; empty: it must not have one."""
    taken: Callable[[Any], Any]
    """Gives the shortcut, from numba's function."""

    @property
    def own(self) -> Any:
        """Numba's function, None if there is none."""
        return vars(self.owner).get(self.name)

    def is_known(self) -> bool:
        """Return whether it was written for this version of numba."""
        return digest_of_source(self.own) == self.digest

    def take(self) -> None:
        """Put it in its place."""
        setattr(self.owner, self.name, self.taken(self.own))


def digest_of_source(function: Any) -> str:
    """Return the digest of the source of a function; empty: there is none."""
    try:
        source = '' if function is None else inspect.getsource(function)
    except (OSError, TypeError):
        return 'unknown'
    return source and hashlib.sha256(source.encode()).hexdigest()[:16]


def take(shortcuts: Iterable[Shortcut]) -> list[str]:
    """Take shortcuts; return the names of those that this version of numba does not allow."""
    unknown = []
    for shortcut in shortcuts:
        if shortcut.is_known():
            shortcut.take()
        else:
            unknown.append(f'{shortcut.owner.__name__}.{shortcut.name}')
    return unknown


def _variables(own: Any) -> Any:
    """List the variables of an instruction without a call for each of its numbers and names."""
    def rec_list_vars(self: Any, value: Any) -> list[Any]:
        if type(value) is not dict:
            return own(self, value)     # type: ignore[no-any-return]
        found: list[Any] = []
        for part in value.values():
            kind = type(part)
            if kind is ir.Var:
                found.append(part)
            elif kind not in _PLAIN:
                found += own(self, part)
        return found
    return rec_list_vars


_PLAIN = frozenset((str, int, bool, float, type(None), ir.Loc))
"""Types of parts of instructions that have no variables."""


def _call_type(own: Any) -> Any:
    """Look up the overload of a function for types of arguments once."""
    known: dict[Any, Any] = {}

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        asked = self, context, tuple(args), tuple(sorted(kws.items())) if kws else ()
        try:
            found = known.get(asked)
        except TypeError:
            return own(self, context, args, kws)
        if found is None:
            found = known[asked] = own(self, context, args, kws)
        return found
    return get_call_type


def _record_text(own: Any) -> Any:
    """Write the text of a record once: it has those of all records in it."""
    known: dict[str, str] = {}

    def text(self: Any) -> str:
        if self.name not in known:
            known[self.name] = own(self)
        return known[self.name]
    return text


def _scope_copy(own: Any) -> Any:
    """Copy a scope, which each block of an inlined kernel does, without its variables."""
    def deepcopy(self: Any, memo: Any) -> Any:
        other = memo[id(self)] = copy.copy(self)
        other.localvars = copy.copy(self.localvars)
        other.localvars._con = dict(self.localvars._con)
        other.redefined = self.redefined.copy()
        other.var_redefinitions = copy.deepcopy(self.var_redefinitions)
        return other
    return deepcopy


def _same(own: Any) -> Any:
    """Share a place in a source instead of a copy of it."""
    return lambda self, memo: self


def _abi_size(own: Any) -> Any:
    """Ask LLVM once for the size of a type: it parses a module for it."""
    known: dict[tuple[Any, str], int] = {}

    def get_abi_sizeof(self: Any, ty: LLVMType) -> int:
        asked = self.target_data, str(ty)
        if asked not in known:
            known[asked] = own(self, ty)
        return known[asked]
    return get_abi_sizeof


COMPILING = (
    Shortcut(ir.Inst, '_rec_list_vars', '054700e9100b6299', _variables),
    Shortcut(ir.Loc, '__deepcopy__', '', _same),
    Shortcut(ir.Scope, '__deepcopy__', '', _scope_copy),
    Shortcut(Record, '__repr__', '1ef92cbe77afb33d', _record_text),
    Shortcut(BaseFunction, 'get_call_type', '6559c167bfc0ad36', _call_type),
    Shortcut(BaseContext, 'get_abi_sizeof', 'd62321a8ccf39a59', _abi_size))
"""Those that have no other user of numba to mind."""
