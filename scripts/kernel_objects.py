"""
Objects of kernels in a directory: each is made once, by the process that needs it first.

Its bitcode is kept: what an edit leaves as it is, and an export, need not be lowered again.
"""

from collections.abc import Iterable
import ctypes
from pathlib import Path
import tempfile
from typing import NamedTuple

from isa_ros.core.kept_objects import bitcode_name, keep, kept
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_key import is_unchanged
from isa_ros.core.kernel_library import address_in, Call, call_in
from isa_ros.core.objects import bitcode_of, library_of, object_of, own_target, TARGETS
from isa_ros.errors import ConfigError


class Objects(NamedTuple):
    """The objects of entries for some targets, and for this machine."""

    directory: Path
    targets: tuple[str, ...]

    def path(self, symbol: str, target: str) -> Path:
        """Return where the object of an entry is, once it is made."""
        return self.directory / f'{symbol}.{target}.o'

    def make(self, entry: KernelEntry) -> dict[str, str]:
        """Make those of an entry that are missing; return why a target has none."""
        missing = [name for name in dict.fromkeys((*self.targets, own_target().name))
                   if not self.path(entry.symbol, name).exists()]
        return self._made(entry, missing) if missing else {}

    def _made(self, entry: KernelEntry, targets: Iterable[str]) -> dict[str, str]:
        """Make those for targets, of bitcode that is kept; return why one has none."""
        kept_name = bitcode_name(entry)
        found = kept(kept_name)
        code = found or bitcode_of(entry)
        refused = {}
        for name in targets:
            try:
                _write(self.path(entry.symbol, name),
                       object_of({entry.symbol: code}, TARGETS[name]))
            except ConfigError as error:
                refused[name] = str(error).rpartition(': ')[2]
        if found is None and not refused and is_unchanged(entry.kernel):
            keep(kept_name, code, _say_nothing)
        return refused

    def address(self, entry: KernelEntry) -> int:
        """
        Return the address of an entry's machine code in this process.

        Raises
        ------
        ConfigError
            It cannot be made.

        """
        return address_in(self._loaded(entry), entry.symbol)

    def call(self, entry: KernelEntry) -> Call:
        """Return what calls an entry with its arguments; raises as `address`."""
        return call_in(self._loaded(entry), entry.symbol)

    def _loaded(self, entry: KernelEntry) -> ctypes.CDLL:
        """Return the library of an entry alone."""
        path = self.directory / f'{entry.symbol}.so'
        if not path.exists():
            refused = self.make(entry).get(own_target().name)
            if refused:
                raise ConfigError(f'kernel {entry.symbol.rpartition("_")[0]}: {refused}')
            with tempfile.TemporaryDirectory(dir=self.directory) as aside:
                library = Path(aside, path.name)
                library_of([self.path(entry.symbol, own_target().name).read_bytes()], library)
                library.replace(path)
        return ctypes.CDLL(str(path))


def _say_nothing(reason: str) -> None:
    """Say nothing where bitcode cannot be kept: the objects are made all the same."""


def _write(path: Path, code: bytes) -> None:
    """Write an object aside and put it in place."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        file.write(code)
    Path(file.name).replace(path)
