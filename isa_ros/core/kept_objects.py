"""Objects of entries in the directory of compiled kernels: a machine makes each once."""

from collections.abc import Mapping
import hashlib

from isa_ros.core.kept_files import read_kept, write_kept
from isa_ros.core.kernel import KernelEntry, symbols_of
from isa_ros.core.kernel_cache import environment, say_not_kept
from isa_ros.core.kernel_directory import CACHE, READ
from isa_ros.core.objects import Target
from numba.core.registry import cpu_target


def kept_name(entries: Mapping[str, KernelEntry], target: Target | None = None) -> str | None:
    """
    Return the name of the file of an object, None: it cannot be kept.

    Without a ``target`` it is that of the bitcode of which the objects of all are made. It has a
    digest of all that these depend on: the entries and their names, the target, the processor for
    which they were optimised, and the versions of the compiler.
    """
    symbols = symbols_of(entries)
    if symbols is None:
        return None
    processor = cpu_target.target_context.codegen().magic_tuple()
    text = repr((environment(), processor, target, tuple(entries), symbols))
    digest = hashlib.sha256(text.encode()).hexdigest()[:32]
    return f'bitcode-{digest}.bc' if target is None else f'{target.name}-{digest}.o'


def kept(name: str | None) -> bytes | None:
    """Return what a file has by its name, None if there is none or it is damaged."""
    found = (read_kept(directory / name) for directory in READ) if name else ()
    return next((bytes(content) for content in found if content is not None), None)


def keep(name: str | None, content: bytes) -> None:
    """Keep what a file has, or print one line why it cannot be kept."""
    if CACHE is None or name is None:
        say_not_kept('no directory is writable' if name else 'as a source is missing')
        return
    try:
        write_kept(CACHE / name, content)
    except OSError as error:
        say_not_kept(error.strerror or str(error))
