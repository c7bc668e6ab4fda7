"""
Objects of the kernels that are exported.

Numba compiles none of them in this process: a process of its own lowers them
(`isa_ros.core.lowering`), so that it can run none, and gives the bitcode of which the object of
each target is made here. A machine does both once: bitcode and objects are kept.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, ExitStack
import os
from pathlib import Path
import pickle
import signal
import subprocess
import sys
import tempfile
from typing import NamedTuple

from isa_ros.core.kept_objects import keep, kept, kept_name, symbols_of
from isa_ros.core.kernel import entry_of, IS_COMPILED, KernelEntry
from isa_ros.core.kinds import kind_of
from isa_ros.core.objects import object_of_bitcode, Target
from isa_ros.errors import ConfigError, RunError
from isa_ros.export.exported import Called
from isa_ros.processes.stopping import PARENT_VARIABLE

_ROOT = Path(__file__).parents[2]
_PROGRAM = (sys.executable, '-m', 'isa_ros.export.lowering_process')


class BitcodeOrder(NamedTuple):
    """What a process makes bitcode of."""

    entries: Mapping[str, KernelEntry]
    """By exported name."""
    symbols: tuple[str, ...] | None
    """What they were when they were asked for."""


def entries_of(kernels: Iterable[Called]) -> dict[str, KernelEntry]:
    """Return kernels without Python around them by the names of their machine code."""
    return {one.name: entry_of(one.function, kind_of(one.memory)) for one in kernels}


def are_kept(groups: Iterable[Iterable[Called]], target: Target) -> bool:
    """Return whether the objects of all groups of kernels are kept for a target."""
    return all(kept(kept_name(entries_of(own), target)) is not None for own in groups)


def objects_of(groups: Iterable[Iterable[Called]], target: Target) -> tuple[bytes, ...]:
    """
    Return the object of each group of kernels; what is not kept is made, of all groups at once.

    Raises
    ------
    ConfigError
        An object would have undefined symbols; they are named.
    RunError
        A process was ended, or its sources are no longer those of this one.

    """
    return objects_of_entries(map(entries_of, groups), target)


def objects_of_entries(
        groups: Iterable[Mapping[str, KernelEntry]], target: Target) -> tuple[bytes, ...]:
    """Return the object of each group of entries by exported names; as `objects_of`."""
    if not IS_COMPILED:
        raise ConfigError('NUMBA_DISABLE_JIT is set, machine code needs the compiler: unset it')
    with ExitStack() as stack:
        begun = [_Object(entries, target, stack) for entries in groups]
        return tuple(own.code() for own in begun)


class _Object:
    """The object of a group of kernels: kept, or of kept bitcode, or of that of a process."""

    def __init__(
            self, entries: Mapping[str, KernelEntry], target: Target, stack: ExitStack) -> None:
        """Start a process, if one is needed, which ends with the context at the latest."""
        self._entries, self._target = entries, target
        self._name, self._bitcode_name = kept_name(entries, target), kept_name(entries)
        self._code, self._bitcode = kept(self._name), kept(self._bitcode_name)
        self._process = None if self._code or self._bitcode else stack.enter_context(
            _lowering(BitcodeOrder(entries, symbols_of(entries))))

    def code(self) -> bytes:
        """Return it, made now if need be; raises as `objects_of`."""
        if self._code is None:
            self._code = object_of_bitcode(self._of_bitcode(), self._entries, self._target)
            keep(self._name, self._code)
        return self._code

    def _of_bitcode(self) -> bytes:
        """Return its bitcode."""
        if self._process is not None:
            self._bitcode = _output_of(self._process)
            keep(self._bitcode_name, self._bitcode)
        assert self._bitcode is not None
        return self._bitcode


@contextmanager
def _lowering(order: BitcodeOrder) -> Iterator['subprocess.Popen[bytes]']:
    """Start a process that lowers kernels; it does not outlive the context, or this process."""
    environment = os.environ | {
        PARENT_VARIABLE: str(os.getpid()),
        'PYTHONPATH': os.pathsep.join(
            [str(_ROOT), *filter(None, [os.environ.get('PYTHONPATH')])])}
    with tempfile.TemporaryFile() as asked:
        asked.write(pickle.dumps(order))
        asked.seek(0)
        try:
            process = subprocess.Popen(
                _PROGRAM, env=environment, cwd=_ROOT, stdin=asked, stdout=subprocess.PIPE,
                stderr=subprocess.PIPE)     # elsewhere are modules of the user
        except OSError as error:
            raise RunError('machine code: no process can be started to make it, '
                           f'{error.strerror or error}') from error
    with process:
        try:
            yield process
        finally:
            process.kill()


def _output_of(process: 'subprocess.Popen[bytes]') -> bytes:
    """Return what a process gives when it has ended; raises as `objects_of`."""
    given, errors = process.communicate()
    said, code = errors.decode(errors='replace'), process.returncode
    last = said.strip().rpartition('\n')[2]
    if code:
        how = (f'was ended by {signal.Signals(-code).name}' if code < 0
               else f'ended with exit code {code}: {last}')
        raise RunError(f'machine code: its process {process.pid} {how}')
    sys.stderr.write(said)
    return given
