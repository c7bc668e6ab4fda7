"""Bitcode and objects of entries in the directory of compiled kernels: made once by a machine."""

from collections.abc import Callable, Iterable, Mapping
import hashlib

from isa_ros.core.kept_files import read_kept, write_kept
from isa_ros.core.kernel import KernelEntry, symbols_of
from isa_ros.core.kernel_cache import environment, say_not_kept
from isa_ros.core.kernel_directory import CACHE, READ
from isa_ros.core.objects import Target
from numba.core.registry import cpu_target


def bitcode_name(entry: KernelEntry) -> str | None:
    """Return the name of the file of an entry's bitcode, None: it cannot be kept."""
    return _name('bitcode', (entry,), 'bc')


def object_name(entries: Mapping[str, KernelEntry], target: Target) -> str | None:
    """Return the name of the file of an object of entries by names, None: it cannot be kept."""
    return _name(target.name, entries.values(), 'o', target, tuple(entries))


def _name(kind: str, entries: Iterable[KernelEntry], end: str, *given: object) -> str | None:
    """
    Return the name of a file.

    It has a digest of all that its content depends on: what is given, the entries, the processor
    for which they were optimised, and the versions of the compiler.
    """
    symbols = symbols_of(entries)
    if symbols is None:
        return None
    processor = cpu_target.target_context.codegen().magic_tuple()
    text = repr((environment(), processor, symbols, *given))
    return f'{kind}-{hashlib.sha256(text.encode()).hexdigest()[:32]}.{end}'


def kept(name: str | None) -> bytes | None:
    """Return what a file has by its name, None if there is none or it is damaged."""
    found = (read_kept(directory / name) for directory in READ) if name else ()
    return next((bytes(content) for content in found if content is not None), None)


def keep(name: str | None, content: bytes,
         say: Callable[[str], object] = say_not_kept) -> None:
    """Keep what a file has, or ``say`` why it cannot be kept: in one line."""
    if CACHE is None or name is None:
        say('no directory is writable' if name else 'as a source is missing')
        return
    try:
        write_kept(CACHE / name, content)
    except OSError as error:
        say(error.strerror or str(error))
