"""Keys of a resolved configuration that are unknown to this version, and keys it lacks."""

from collections.abc import Iterator

from isa_ros.config.runs.run_config import modern, RUN
from isa_ros.config.text.schema import KeyDifference
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree


def key_differences(tree: Tree, place: Place) -> Iterator[KeyDifference]:
    """Yield what a resolved configuration has that is unknown here, and what it lacks."""
    yield from RUN.differences(modern(tree), place)
