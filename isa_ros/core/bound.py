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
from typing import Any, NamedTuple

from isa_ros.core.kernel import address_of, entry_of, IS_COMPILED, kernel
from isa_ros.core.pointers import call_at, kind_of
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

    The arrays of the memory must stay where they are. ``function`` takes the memory alone.
    """

    def __init__(self, function: Any, memory: Any) -> None:
        self.function, self.memory = function, memory
        self.table = table_of(memory)
        """What the machine code is called with."""
        self.address = 0
        """Of the machine code; 0 without the compiler."""
        if IS_COMPILED:
            self.address = address_of(entry_of(function, kind_of(memory)))
            called, table = _CALLED(self.address), ctypes.c_void_p(self.table.ctypes.data)
            self.run: Callable[[], int] = lambda: called(table)
        else:
            records = _with_attributes(memory)
            self.run = lambda: int(function(records))


def _with_attributes(memory: Any) -> Any:
    """Return a memory whose rows have attributes, for kernels that are plain Python."""
    parts = [_with_attributes(part) if isinstance(part, tuple)
             else part if part.dtype.names is None else np.asarray(part.view(np.recarray))
             for part in memory]
    return type(memory)(*parts)


@kernel
def run_rounds(rounds, program):
    """
    Run the bound kernels of a program one after the other, in so many rounds.

    ``program`` has address and table of each, (n, 2). One that returns another number than 0 is
    the last. Return the rounds that were finished, the place of that kernel or -1, and its
    number.
    """
    for done in range(rounds):
        for k in range(len(program)):
            found = call_at(program[k, 0], program[k, 1])
            if found != 0:
                return done, k, found
    return rounds, -1, 0


class Program:
    """Bound kernels that are run one after the other, in rounds."""

    def __init__(self, parts: Sequence[Bound]) -> None:
        self.parts = tuple(parts)
        self._program = np.array(
            [(part.address, part.table.ctypes.data) for part in parts], np.int64).reshape(-1, 2)

    def run(self, rounds: int) -> tuple[int, int, int]:
        """Run so many rounds; a kernel that finds something ends them, as in `run_rounds`."""
        if IS_COMPILED:
            done, place, found = run_rounds(rounds, self._program)
            return int(done), int(place), int(found)
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
        if self._bound is None or any(
                array is not other for array, other in zip(given, self._given, strict=True)):
            self._given, self._bound = given, Bound(self._function, self._memory(*given))
        return self._bound
