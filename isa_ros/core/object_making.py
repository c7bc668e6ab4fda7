"""
Objects of entries, made once by a machine.

A process of its own gives the bitcode (`isa_ros.core.bitcode`) of which the object of each target
is made here. Bitcode and objects are kept.
"""

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack

from isa_ros.core.bitcode import lowering
from isa_ros.core.kept_objects import keep, kept, kept_name
from isa_ros.core.kernel import IS_COMPILED, KernelEntry
from isa_ros.core.objects import object_of_bitcode, Target
from isa_ros.errors import ConfigError


def objects_of_entries(
        groups: Iterable[Mapping[str, KernelEntry]], target: Target,
        tell: Callable[[str], object] = str) -> tuple[bytes, ...]:
    """
    Return the object of each group of entries by exported names; all that is not kept is begun.

    ``tell`` is called with what a process tells meanwhile (`isa_ros.core.bitcode.BitcodeOrder`).

    Raises
    ------
    ConfigError
        An object would have undefined symbols; they are named.
    RunError
        A process was ended, or its sources are no longer those of this one.

    """
    if not IS_COMPILED:
        raise ConfigError('NUMBA_DISABLE_JIT is set, machine code needs the compiler: unset it')
    with ExitStack() as stack:
        begun = [_Object(entries, target, stack) for entries in groups]
        return tuple(own.code(tell) for own in begun)


class _Object:
    """The object of a group of entries: kept, or of kept bitcode, or of that of a process."""

    def __init__(
            self, entries: Mapping[str, KernelEntry], target: Target, stack: ExitStack) -> None:
        """Start a process, if one is needed, which ends with the context at the latest."""
        self._entries, self._target = entries, target
        self._name, self._bitcode_name = kept_name(entries, target), kept_name(entries)
        self._code, self._bitcode = kept(self._name), kept(self._bitcode_name)
        self._lowering = None if self._code or self._bitcode else stack.enter_context(
            lowering(entries))

    def code(self, tell: Callable[[str], object]) -> bytes:
        """Return it, made now if need be; raises as `objects_of_entries`."""
        if self._code is None:
            bitcode = self._bitcode
            if self._lowering is not None:
                bitcode = self._lowering.bitcode(tell)
            assert bitcode is not None
            self._code = object_of_bitcode(bitcode, self._entries, self._target)
            if self._lowering is not None:
                keep(self._bitcode_name, bitcode)
            keep(self._name, self._code)
        return self._code
