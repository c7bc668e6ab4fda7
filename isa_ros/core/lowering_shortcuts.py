"""
Shortcuts through numba for a process that only lowers kernels, `isa_ros.core.lowering`.

They leave out what objects have no use for: the times that passes take and their names, messages
to who listens to the compiler, and lives of variables that only generators and Python's objects
need.
"""

from contextlib import nullcontext
from typing import Any
import warnings

from isa_ros.core.shortcuts import COMPILING, Shortcut
from numba.core import errors, event, ir, lowering, transforms, typeinfer
from numba.core.compiler_machinery import FunctionPass, PassManager
from numba.core.inline_closurecall import InlineClosureCallPass
from numba.core.ir_utils import enforce_no_dels
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.utils import chain_exception

_ERRORS: Any = errors       # with what has no types


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


LOWERING = (
    *COMPILING,
    Shortcut(PassManager, '_runPass', 'ecb83032771bf665', _run_pass),
    Shortcut(lowering, 'new_error_context', '4fc2406a52cead53', _context),
    Shortcut(typeinfer, 'new_error_context', '4fc2406a52cead53', _context),
    Shortcut(event, 'install_timer', '754d2f8aad8c47d3', _untimed),
    Shortcut(InlineClosureCallPass, 'run', 'd826ba18dd6371ea', _inline_closures),
    Shortcut(typeinfer.ConstraintNetwork, 'propagate', '01b516bfb28ce9fc', _propagate),
    Shortcut(PostProcessor, 'run', 'e1a8e77d6f179cfd', _process))
"""All of a process that only lowers kernels."""
