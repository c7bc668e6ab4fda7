"""
Kernels bound to their memory: what a loop of ticks, in Python or compiled, calls.

A bound kernel takes one argument, a `NamedTuple` of arrays that is its whole memory, and returns
a whole number. Its machine code has the C signature ``int64_t f(const int64_t *table)``: the
table has address and shape of every array. So a compiled loop calls what it was not compiled
with, Python calls it without looking at each array again, and a program without Python can call
it too.
"""

from collections.abc import Callable, Iterator, Sequence
import ctypes
from operator import is_
from typing import Any, NamedTuple

from isa_ros.core.kernel import entry_of, IS_COMPILED, kernel
from isa_ros.core.kinds import kind_of
from isa_ros.core.pointers import call_at
from isa_ros.core.record import attributed
import numpy as np
from numpy.typing import NDArray

_CALLED = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)


def arrays_of(memory: Any) -> Iterator[NDArray[Any]]:
    """
    Yield the arrays of a memory, those of nested ones in their place.

    Raises
    ------
    ValueError
        An array has gaps between its rows, or one of them is none.

    """
    for part in memory:
        if isinstance(part, tuple):
            yield from arrays_of(part)
        elif isinstance(part, np.ndarray) and part.flags.c_contiguous:
            yield part
        else:
            raise ValueError(f'{part!r} is not an array without gaps')


def table_of(memory: Any) -> NDArray[np.int64]:
    """Return address and shape of every array of a memory, one after the other."""
    return np.array([number for array in arrays_of(memory)
                     for number in (array.ctypes.data, *array.shape)], np.int64)


class Bound:
    """
    A kernel over its ``memory``; a call runs it and returns what it returns.

    The arrays of the memory must stay where they are. ``function`` takes the memory alone. Whoever
    has ``run`` alone keeps all that it reads.
    """

    def __init__(self, function: Any, memory: Any) -> None:
        self.function, self.memory = function, memory
        self.table = table_of(memory)
        """What the machine code is called with."""
        self.address = 0
        """Of the machine code; 0 without the compiler."""
        if IS_COMPILED:
            self.address = entry_of(function, kind_of(memory)).address()
            self.run: Callable[[], int] = _call_of(self.address, self.table, memory)
        else:
            records = _with_attributes(memory)
            self.run = lambda: int(function(records))


def _call_of(address: int, table: NDArray[np.int64], memory: Any) -> Callable[[], int]:
    """Return a call of machine code over a table, which keeps the table and what it refers to."""
    called, pointer, kept = _CALLED(address), ctypes.c_void_p(table.ctypes.data), (table, memory)

    def call(pointer: ctypes.c_void_p = pointer, kept: Any = kept) -> int:
        found: int = called(pointer)
        return found
    return call


def _with_attributes(memory: Any) -> Any:
    """Return a memory whose rows have attributes, for kernels that are plain Python."""
    parts = [_with_attributes(part) if isinstance(part, tuple)
             else part if part.dtype.names is None else part.view(attributed(part.dtype))
             for part in memory]
    form = type(memory)
    return tuple(parts) if form is tuple else form(*parts)


class Rounds(NamedTuple):
    """Memory of a program."""

    numbers: NDArray[np.int64]
    """Rounds to run, and what they return as `Program.run`, (4,)."""
    parts: NDArray[np.int64]
    """Address and table of each bound kernel, (n, 2)."""


@kernel
def run_rounds(own):
    """
    Run the bound kernels of a program one after the other, in so many rounds.

    One that returns another number than 0 is the last. Write the rounds that were finished, the
    place of that kernel or -1, and its number.
    """
    for done in range(own.numbers[0]):
        for k in range(len(own.parts)):
            found = call_at(own.parts[k, 0], own.parts[k, 1])
            if found != 0:
                own.numbers[1], own.numbers[2], own.numbers[3] = done, k, found
                return 1
    own.numbers[1], own.numbers[2], own.numbers[3] = own.numbers[0], -1, 0
    return 0


class Program:
    """Bound kernels that are run one after the other, in rounds."""

    def __init__(self, parts: Sequence[Bound]) -> None:
        self.parts = tuple(parts)
        if IS_COMPILED:
            self._rounds = Rounds(np.zeros(4, np.int64), np.array(
                [(part.address, part.table.ctypes.data) for part in parts],
                np.int64).reshape(-1, 2))
            self._bound = Bound(run_rounds, self._rounds)

    def run(self, rounds: int) -> tuple[int, int, int]:
        """
        Run so many rounds; a kernel that returns another number than 0 ends them.

        Return the rounds that were finished, the place of that kernel or -1, and its number.
        """
        if IS_COMPILED:
            self._rounds.numbers[0] = rounds
            self._bound.run()
            done, place, found = self._rounds.numbers[1:].tolist()
            return done, place, found
        for done in range(rounds):
            for place, part in enumerate(self.parts):
                found = part.run()
                if found:
                    return done, place, found
        return rounds, -1, 0


class Part(NamedTuple):
    """A bound kernel in a program, and what is called with a number other than 0 of it."""

    bound: Bound
    found: Callable[[int], object]


def nothing(found: int) -> None:
    """Do nothing: such a kernel finds nothing, or what it finds needs no answer."""


class Rebound:
    """
    A kernel over a memory of which some arrays are given at each call.

    ``memory`` returns the memory for them. As long as they are the same, one `Bound` is used.
    """

    def __init__(self, function: Any, memory: Callable[..., Any]) -> None:
        self._function, self._memory = function, memory
        self._given: tuple[NDArray[Any], ...] = ()
        self._bound: Bound | None = None

    def to(self, *given: NDArray[Any]) -> Bound:
        """Return the kernel over the memory with these arrays."""
        if self._bound is None or not all(map(is_, given, self._given)):
            self._given, self._bound = given, Bound(self._function, self._memory(*given))
        return self._bound
