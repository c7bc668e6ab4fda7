"""Which tests a worker of pytest-xdist gets, and in which order."""

import pytest
from xdist.scheduler import LoadFileScheduling

LINTERS = 'tests/style/'


class ByFile(LoadFileScheduling):
    """
    A file's tests go to one worker, which makes its module's fixtures once; so do all linters.

    They need no kernels, so one worker runs them while another compiles.
    """

    def _split_scope(self, nodeid: str) -> str:
        return LINTERS if nodeid.startswith(LINTERS) else super()._split_scope(nodeid)


def long_files_first(items: list[pytest.Item]) -> None:
    """Sort by file: linters, files with slow tests or nodes, the quick rest to fill the end."""
    long = {item.path for item in items
            if item.get_closest_marker('slow') or item.get_closest_marker('ros')}
    items.sort(key=lambda item: (
        not item.nodeid.startswith(LINTERS), item.path not in long))
