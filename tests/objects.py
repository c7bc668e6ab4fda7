"""Objects of entries as this process has them."""

from collections.abc import Mapping

from isa_ros.core.kernel import KernelEntry
from isa_ros.core.objects import bitcode_of, object_of, Target


def made_object(entries: Mapping[str, KernelEntry], target: Target) -> bytes:
    """Return the object of entries by exported names; raises as `object_of`."""
    return object_of({name: bitcode_of(entry) for name, entry in entries.items()}, target)
