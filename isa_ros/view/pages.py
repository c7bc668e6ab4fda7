"""What a page gets first: the same for a run and for a bag."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.view.nodes import SceneNode, tree_of as nodes_tree
from isa_ros.view.panels import channels_of, Group, tree_of as groups_tree


class ViewPage(NamedTuple):
    """What is shown of a run."""

    title: str
    groups: Sequence[Group]
    nodes: Sequence[SceneNode]

    @property
    def channels(self) -> list[str]:
        """Return the channels in the order of a frame."""
        return channels_of(self.groups, self.nodes)

    def tree(self, run: RunConfig, kind: str, end_s: float | None, **more: Any
             ) -> Mapping[str, Any]:
        """Return it for JSON; ``kind`` is run or bag, ``end_s`` its end if that is known."""
        place_of = {name: k for k, name in enumerate(self.channels)}
        return {
            'title': self.title, 'kind': kind, 'step': run.step_ns / NS_PER_SECOND, 'end': end_s,
            'channels': len(place_of), 'groups': groups_tree(self.groups, place_of),
            'scene': nodes_tree(self.nodes, place_of), **more}
