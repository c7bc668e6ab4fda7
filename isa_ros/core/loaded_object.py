"""The machine code of an object, run in this process: it takes no linker."""

import ctypes
import inspect
import json
from typing import Any

from isa_ros.core.kernel_library import Call, result_symbol
from isa_ros.core.kinds import kind_of_form
import llvmlite.binding as llvm

_ENGINES: list[Any] = []    # with the code to which addresses refer, until the process ends


def can_load() -> bool:
    """Return whether the compiler can load objects into one block of memory."""
    return 'use_lmm' in inspect.signature(llvm.create_mcjit_compiler).parameters


class LoadedObject:
    """An object of `isa_ros.core.objects`."""

    def __init__(self, code: bytes) -> None:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        # In one block of memory: code refers to its numbers by 32 bits, which is not enough where
        # a large array has left the only room for them far away.
        self._engine = llvm.create_mcjit_compiler(
            llvm.parse_assembly(''), llvm.Target.from_default_triple().create_target_machine(),
            use_lmm=True)
        _ENGINES.append(self._engine)
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()

    def address(self, symbol: str) -> int:
        """Return the address of the machine code of an entry."""
        found: int = self._engine.get_function_address(symbol)
        return found

    def call(self, symbol: str) -> Call:
        """Return what calls a called entry with its arguments."""
        form = ctypes.string_at(self._engine.get_global_value_address(result_symbol(symbol)))
        return Call(self.address(symbol), kind_of_form(json.loads(form)))
