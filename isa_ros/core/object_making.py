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


def needs_no_process(
        groups: Iterable[Mapping[str, KernelEntry]], target: Target) -> bool:
    """Return whether all objects are kept, or the bitcode that they are made of is."""
    return all(kept(object_name(own, target)) or len(_kept_bitcodes(own)) == len(own)
               for own in groups)


def _kept_bitcodes(entries: Mapping[str, KernelEntry]) -> dict[str, bytes]:
    """Return the bitcode of the entries of which it is kept."""
    found = ((name, kept(bitcode_name(own))) for name, own in entries.items())
    return {name: code for name, code in found if code}


class _Object:
    """The object of a group of entries: kept, or made of bitcode that is kept or of a process."""

    def __init__(
            self, entries: Mapping[str, KernelEntry], target: Target, stack: ExitStack) -> None:
        """Start a process, if one is needed, which ends with the context at the latest."""
        self._entries, self._target = entries, target
        self._name = object_name(entries, target)
        self._code = kept(self._name)
        self._bitcodes = _kept_bitcodes(entries) if self._code is None else {}
        self._missing = () if self._code else tuple(
            own for name, own in entries.items() if name not in self._bitcodes)
        self._lowering = stack.enter_context(lowering(self._missing)) if self._missing else None

    def code(self, tell: Callable[[str], object]) -> bytes:
        """Return it, made now if need be; raises as `objects_of_entries`."""
        if self._code is None:
            made = () if self._lowering is None else self._lowering.bitcodes(tell)
            lowered = dict(zip(self._missing, made, strict=True))
            self._code = object_of(
                {name: self._bitcodes.get(name) or lowered[own]
                 for name, own in self._entries.items()}, self._target)
            for entry, code in lowered.items():
                keep(bitcode_name(entry), code)
            keep(self._name, self._code)
        return self._code
