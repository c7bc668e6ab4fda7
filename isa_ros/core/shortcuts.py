"""
Shortcuts through numba for a process that only lowers kernels, `isa_ros.core.lowering`.

What its compiler does many times over for one kernel is done once; what objects have no use for is
left out: the times that passes take and their names, messages to who listens to the compiler, and
lives of variables that only generators and Python's objects need. Each stands in the place of a
function of numba and gives the same instructions of LLVM. It is taken only where numba's own
source is the one that it was written for: another version of numba compiles as it always does,
only slower.
"""

from collections.abc import Callable, Iterable
from contextlib import nullcontext
import copy
import hashlib
import inspect
from typing import Any, NamedTuple
import warnings

from llvmlite.ir.types import Type as LLVMType
from numba.core import errors, event, ir, lowering, transforms, typeinfer
from numba.core.base import BaseContext
from numba.core.compiler_machinery import FunctionPass, PassManager
from numba.core.inline_closurecall import InlineClosureCallPass
from numba.core.ir_utils import enforce_no_dels
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.types import Record
from numba.core.types.functions import BaseFunction
from numba.core.utils import chain_exception

_ERRORS: Any = errors       # with what has no types


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


def _run_pass(own: Any) -> Any:
    """Run a pass and describe it to nobody, if nobody listens."""
    def run_pass(self: Any, index: int, compiler_pass: Any, state: Any) -> None:
        if event._registered['numba:run_pass'] or self._print_before or self._print_after \
                or self._print_wrap:
            return own(self, index, compiler_pass, state)   # type: ignore[no-any-return]
        compiler_pass.analysis = self._analysis
        with _ERRORS.new_error_context('Pass {name}', name=compiler_pass.name()):
            compiler_pass.run_initialization(state)
            compiler_pass.run_pass(state)
            compiler_pass.run_finalizer(state)
        if isinstance(compiler_pass, FunctionPass):
            enforce_no_dels(state.func_ir)  # type: ignore[no-untyped-call]
        return None
    return run_pass


def _process(own: Any) -> Any:
    """Leave out which variables live where, which only generators and Python's objects need."""
    def run(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        function = self.func_ir
        if function.is_generator:
            return own(self, emit_dels, extend_lifetimes)   # type: ignore[no-any-return]
        blocks = transforms.canonicalize_cfg(function.blocks)   # type: ignore[no-untyped-call]
        function.blocks = blocks
        function.variable_lifetime = VariableLifetime(blocks)   # type: ignore[no-untyped-call]
        function.generator_info = None
        if emit_dels:
            self._insert_var_dels(extend_lifetimes=extend_lifetimes)
        return None
    return run


def _context(own: Any) -> Any:
    """Note where an error arises, of all instructions and passes, without a generator for each."""
    class Context:
        def __init__(self, text: str, *arguments: Any, **named: Any) -> None:
            self._said = text, arguments, named
            place = named.get('loc')
            if place is not None and not place.filename.startswith(_ERRORS._numba_path):
                _ERRORS.loc_info.update(named)

        def __enter__(self) -> None:
            pass

        def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
            if isinstance(error, errors.NumbaError):
                error.add_context(_ERRORS._format_msg(*self._said))
    return Context


def _untimed(own: Any) -> Any:
    """Measure no time: each kernel would be told of each lock taken below it."""
    return lambda kind, callback: nullcontext()


def _inline_closures(own: Any) -> Any:
    """Look for what may be inlined before the lives of all variables are found for it."""
    def run(self: Any) -> None:
        if any(_may_be_inlined(part.value) for block in self.func_ir.blocks.values()
               for part in block.body if isinstance(part, ir.Assign)):
            own(self)
    return run


_INLINED = ('reduce', 'stencil')


def _may_be_inlined(value: Any) -> bool:
    """Return whether a value is a function within a function, a list, or one of `_INLINED`."""
    if isinstance(value, ir.Expr):
        return value.op in ('make_function', 'build_list') or (
            value.op == 'getattr' and value.attr in _INLINED)
    return isinstance(value, (ir.Global, ir.FreeVar)) and (
        value.name in _INLINED or getattr(value.value, '__name__', '') in _INLINED)


def _propagate(own: Any) -> Any:
    """Catch the warnings of all constraints at once, and give each the place of its own."""
    def propagate(self: Any, inferer: Any) -> list[Any]:
        failures: list[Any] = []
        places: list[Any] = []
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter('always', errors.NumbaWarning)
            for constraint in self.constraints:
                try:
                    constraint(inferer)
                except errors.ForceLiteralArg as error:
                    failures.append(error)
                except errors.TypingError as error:
                    failure = errors.TypingError(
                        str(error), loc=constraint.loc, highlighting=False)
                    failures.append(
                        chain_exception(failure, error))    # type: ignore[no-untyped-call]
                places += [constraint.loc] * (len(caught) - len(places))
        for warning, place in zip(caught, places):
            with inferer.warnings.catch_warnings(filename=place.filename, lineno=place.line):
                warnings.warn_explicit(
                    warning.message, warning.category, warning.filename, warning.lineno)
        return failures
    return propagate


SHORTCUTS = (
    Shortcut(ir.Inst, '_rec_list_vars', '054700e9100b6299', _variables),
    Shortcut(ir.Loc, '__deepcopy__', '', _same),
    Shortcut(ir.Scope, '__deepcopy__', '', _scope_copy),
    Shortcut(Record, '__repr__', '1ef92cbe77afb33d', _record_text),
    Shortcut(BaseFunction, 'get_call_type', '6559c167bfc0ad36', _call_type),
    Shortcut(BaseContext, 'get_abi_sizeof', 'd62321a8ccf39a59', _abi_size),
    Shortcut(PassManager, '_runPass', 'ecb83032771bf665', _run_pass),
    Shortcut(lowering, 'new_error_context', '4fc2406a52cead53', _context),
    Shortcut(typeinfer, 'new_error_context', '4fc2406a52cead53', _context),
    Shortcut(event, 'install_timer', '754d2f8aad8c47d3', _untimed),
    Shortcut(InlineClosureCallPass, 'run', 'd826ba18dd6371ea', _inline_closures),
    Shortcut(typeinfer.ConstraintNetwork, 'propagate', '01b516bfb28ce9fc', _propagate),
    Shortcut(PostProcessor, 'run', 'e1a8e77d6f179cfd', _process))
