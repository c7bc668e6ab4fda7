"""Objects of the kernels that are exported; a machine makes each once."""

from collections.abc import Iterable

from isa_ros.core.kernel import entry_of, KernelEntry
from isa_ros.core.kinds import kind_of
from isa_ros.core.object_making import needs_no_process, objects_of_entries
from isa_ros.core.objects import Target
from isa_ros.export.exported import Called


def entries_of(kernels: Iterable[Called]) -> dict[str, KernelEntry]:
    """Return kernels without Python around them by the names of their machine code."""
    return {one.name: entry_of(one.function, kind_of(one.memory)) for one in kernels}


def are_lowered(groups: Iterable[Iterable[Called]], target: Target) -> bool:
    """Return whether all groups of kernels take no long time: what is long is kept."""
    return needs_no_process(map(entries_of, groups), target)


def objects_of(groups: Iterable[Iterable[Called]], target: Target) -> tuple[bytes, ...]:
    """Return the object of each group of kernels; raises as `objects_of_entries`."""
    return objects_of_entries(map(entries_of, groups), target)
