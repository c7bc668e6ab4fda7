"""
Bitcode of entries, made by a process of its own.

Numba compiles none of them in this one: that one lowers them (`isa_ros.core.lowering`), and so can
run none.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, ExitStack, suppress
import json
import os
from pathlib import Path
import pickle
import signal
import subprocess
import sys
import tempfile
from typing import BinaryIO, IO, NamedTuple, TextIO

from isa_ros.core.kernel import KernelEntry, symbols_of
from isa_ros.core.kernel_cache import environment
from isa_ros.core.openblas import without_threads
from isa_ros.core.parent import PARENT_VARIABLE
from isa_ros.errors import one_line, RunError

_ROOT = Path(__file__).parents[2]
_FIRST = 'import json, sys; sys.path[:] = json.loads(sys.argv[1])\n'
"""Of the process: it takes modules from where this one does."""
_PROGRAM = 'from isa_ros.core.lowering_process import main; sys.exit(main())'


class BitcodeOrder(NamedTuple):
    """What a process makes bitcode of."""

    entries: tuple[KernelEntry, ...]
    symbols: tuple[str, ...] | None
    """What they were when they were asked for."""
    environment: str
    """The versions of the compiler, and its settings."""
    told: int
    """File descriptor for the name of each kernel as it begins, and an empty line as it ends."""


class BitcodeProcess:
    """A process that makes bitcode."""

    def __init__(self, process: 'subprocess.Popen[bytes]', told: TextIO, code: BinaryIO,
                 errors: BinaryIO) -> None:
        self._process, self._told, self._code, self._errors = process, told, code, errors

    def bitcodes(self, tell: Callable[[str], object] = str) -> tuple[bytes, ...]:
        """
        Return that of each entry when all is made; ``tell`` is called with lines told meanwhile.

        Raises
        ------
        RunError
            The process was ended, or its sources are no longer those of this one.

        """
        for line in self._told:
            tell(line.rstrip('\n'))
        code = self._process.wait()
        said = _read(self._errors).decode(errors='replace')
        last = said.strip().rpartition('\n')[2]
        if code:
            how = (f'was ended by {signal.Signals(-code).name}' if code < 0
                   else f'ended with exit code {code}: {last}')
            raise RunError(f'machine code: its process {self._process.pid} {how}')
        if said and sys.stderr is not None:
            with suppress(OSError, ValueError):     # it may be closed
                sys.stderr.write(said)
        try:
            made: tuple[bytes, ...] = pickle.loads(_read(self._code))
        except (EOFError, pickle.UnpicklingError) as error:
            raise RunError(f'machine code: {one_line(str(error))}') from error
        return made


def _read(file: BinaryIO) -> bytes:
    """Return all that another process has written."""
    file.seek(0)
    return file.read()


@contextmanager
def lowering(entries: tuple[KernelEntry, ...]) -> Iterator[BitcodeProcess]:
    """
    Start a process that lowers entries; it does not outlive the context.

    Nor does it outlive this process. Modules of the folder in which this one runs are not taken.
    Ctrl-C is for this process alone.

    Raises
    ------
    RunError
        None can be started.

    """
    with ExitStack() as stack:
        try:
            asked, code, errors = (
                stack.enter_context(tempfile.TemporaryFile()) for _ in range(3))
            told, tells = os.pipe()
            lines = stack.enter_context(os.fdopen(told))
            try:
                order = BitcodeOrder(entries, symbols_of(entries), environment(), tells)
                process = _started(order, asked, code, errors)
            finally:
                os.close(tells)
        except (OSError, pickle.PicklingError, AttributeError, TypeError) as error:
            # An entry in a function has no name by which it is pickled; a program may be embedded.
            raise RunError('machine code: no process can be started to make it, '
                           f'{getattr(error, "strerror", None) or error}') from error
        with process:
            try:
                yield BitcodeProcess(process, lines, code, errors)
            finally:
                process.kill()


def _started(order: BitcodeOrder, asked: IO[bytes], code: IO[bytes],
             errors: IO[bytes]) -> 'subprocess.Popen[bytes]':
    """Start the process of an order."""
    asked.write(pickle.dumps(order))
    asked.seek(0)
    # '' is the folder in which this process runs; that one runs where there is one.
    places = [os.path.abspath(place) for place in sys.path if place]
    if str(_ROOT) not in places:
        places.insert(0, str(_ROOT))
    program = (sys.executable, '-I', '-c', _FIRST + _PROGRAM, json.dumps(places))
    inherited = os.environ | {PARENT_VARIABLE: str(os.getpid())}
    without_threads(inherited)
    return subprocess.Popen(
        program, cwd=_ROOT, stdin=asked, stdout=code, stderr=errors, pass_fds=(order.told,),
        start_new_session=True, env=inherited)
