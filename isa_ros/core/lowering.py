"""
Kernels lowered for objects: what a process does that runs none of them.

numba optimises a kernel, emits it and adds its wrappers for Python before it compiles the next
one, which has it inlined and optimises it again. Where only the objects of a few entries are
wanted, a kernel can stay the instructions of LLVM that numba has written first: an entry is linked
of all that it reaches, and optimised once, by the same passes.
"""

from collections.abc import Iterator
import gc
from typing import Any

from isa_ros.core.shortcuts import SHORTCUTS, take
from llvmlite.ir.instructions import CallInstr
from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core.codegen import CPUCodeLibrary
from numba.core.registry import cpu_target
from numba.core.runtime.nrt import rtsys

LARGE = 3000
"""
Instructions, with all that is called, beyond which LLVM decides whether a function is inlined.

Without a bound the object of the actuators' tick has 750 kB instead of 220 and takes twice as
long; a tick of the leg then takes 2 % less, one of a rig with hoses 5 %.
"""
_NOWHERE = 1    # the address of what is not emitted


class Lowered(CPUCodeLibrary):
    """One kernel as it is lowered, and the libraries of those that it calls."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)  # type: ignore[no-untyped-call]
        self.sizes: dict[str, int] = {}
        """Instructions of its functions, by name, with all that they call."""

    def add_ir_module(self, ir_module: Any) -> None:
        """Take instructions; LLVM decides about large functions."""
        sizes = {name: size for library in self._linking_libraries
                 for name, size in getattr(library, 'sizes', {}).items()}
        for function in ir_module.functions:
            if function.blocks:
                size = self.sizes[function.name] = _size(function, sizes)
                if size > LARGE:
                    function.attributes.discard('alwaysinline')
        super().add_ir_module(ir_module)  # type: ignore[no-untyped-call]

    def finalize(self) -> None:
        """Leave it as it is: only entries are optimised."""
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """Return the kernel with all that it reaches, optimised."""
        if self._shared_module is None:
            own = {function.name for function in self._final_module.functions
                   if not function.is_declaration}
            for library in _reached(self):
                self._final_module.link_in(library._final_module, preserve=True)
            for function in self._final_module.functions:
                if not function.is_declaration and function.name not in own:
                    function.linkage = 'internal'
            self._optimize_final_module()  # type: ignore[no-untyped-call]
            self._shared_module = self._final_module
        return self._shared_module


def _size(function: Any, sizes: dict[str, int]) -> int:
    """Return the instructions of a function with those that it calls, of known ``sizes``."""
    return sum(1 + (sizes.get(own.callee.name, 0) if isinstance(own, CallInstr) else 0)
               for block in function.blocks for own in block.instructions)


def _reached(library: Any) -> Iterator[Any]:
    """Yield the libraries that a library reaches, each once."""
    found = {id(library)}
    waiting = [library]
    while waiting:
        for other in waiting.pop()._linking_libraries:
            if id(other) not in found:
                found.add(id(other))
                waiting.append(other)
                yield other


def _not_emitted(library: Any, fndesc: Any, environment: Any) -> Any:
    """Return what stands for a kernel where numba asks for its machine code; no one calls it."""
    return _dynfunc.make_function(
        fndesc.lookup_module(), fndesc.qualname.rpartition('.')[2], '', _NOWHERE, environment,
        (library,))


def _no_wrapper(*arguments: Any, **named: Any) -> None:
    """Make nothing that Python or C calls: entries have their own."""


def declare() -> None:
    """Let numba know all that kernels may call, which the first one would wait for."""
    context: Any = cpu_target.target_context
    context.refresh()


def lower_only() -> None:
    """Let this process lower kernels from now on: they get into objects, and none can be run."""
    take(SHORTCUTS)
    context: Any = cpu_target.target_context
    rtsys.initialize(context)   # its functions are compiled as always
    context.codegen()._library_class = Lowered
    context.get_executable = _not_emitted
    context.create_cpython_wrapper = context.create_cfunc_wrapper = _no_wrapper


def lower_long() -> None:
    """
    Let this process lower kernels only, for as long as it lives.

    What the compiler keeps is seldom looked through for what nobody refers to: an eighth of the
    time, and 80 MB more.
    """
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)
    lower_only()
