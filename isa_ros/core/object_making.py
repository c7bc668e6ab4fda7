"""
Objects of entries, made once by a machine.

A process of its own gives the bitcode of each (`isa_ros.core.bitcode`) of which the objects of all
targets are made here. Bitcode and objects are kept.
"""

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack

from isa_ros.core.bitcode import lowering
from isa_ros.core.kept_objects import bitcode_name, keep, kept, object_name
from isa_ros.core.kernel import IS_COMPILED, KernelEntry
from isa_ros.core.objects import object_of, Target
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
    """The object of a group of entries: kept, or made of bitcode that is kept or of a process."""

    def __init__(
            self, entries: Mapping[str, KernelEntry], target: Target, stack: ExitStack) -> None:
        """Start a process, if one is needed, which ends with the context at the latest."""
        self._target, self._name = target, object_name(entries, target)
        self._code = kept(self._name)
        self._bitcodes: dict[str, bytes | None] = {}
        self._lowered: dict[str, KernelEntry] = {}
        if self._code is None:
            self._bitcodes = {name: kept(bitcode_name(own)) for name, own in entries.items()}
            self._lowered = {name: entries[name]
                             for name, code in self._bitcodes.items() if code is None}
        self._lowering = stack.enter_context(
            lowering(tuple(self._lowered.values()))) if self._lowered else None

    def code(self, tell: Callable[[str], object]) -> bytes:
        """Return it, made now if need be; raises as `objects_of_entries`."""
        if self._code is None:
            made = () if self._lowering is None else self._lowering.bitcodes(tell)
            self._bitcodes.update(zip(self._lowered, made))
            self._code = object_of(
                {name: code for name, code in self._bitcodes.items() if code}, self._target)
            for entry, code in zip(self._lowered.values(), made):
                keep(bitcode_name(entry), code)
            keep(self._name, self._code)
        return self._code
