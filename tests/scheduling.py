"""Which tests a worker of pytest-xdist gets, in which order, and how it finds them."""

from contextlib import suppress
from importlib import import_module
from pathlib import Path

import pytest
from xdist.scheduler import LoadFileScheduling

LINTERS = 'tests/style/'
OWN_KERNELS = 'tests/golden/test_shipped_kernels.py', 'tests/scripts/test_make_kernels.py'
"""Files whose tests make kernels by themselves, and wait for none."""


class ByFile(LoadFileScheduling):
    """
    A file's tests go to one worker, which makes its module's fixtures once; so do all linters.

    They need no kernels, so one worker runs them while another compiles.
    """

    def _split_scope(self, nodeid: str) -> str:
        return LINTERS if nodeid.startswith(LINTERS) else super()._split_scope(nodeid)


def needs_kernels(item: pytest.Item) -> bool:
    """Return whether a test waits for the kernels of the shipped configurations."""
    return not item.nodeid.startswith((LINTERS, *OWN_KERNELS))


def long_files_first(items: list[pytest.Item]) -> None:
    """
    Sort by file: first what needs no kernels, but for one file whose worker compiles meanwhile.

    Then files with slow tests or nodes; the quick rest fills the end.
    """
    long = {item.path for item in items
            if item.get_closest_marker('slow') or item.get_closest_marker('ros')}
    compiling = next((item.path for item in items if item.path in long and needs_kernels(item)),
                     None)
    items.sort(key=lambda item: (
        not item.nodeid.startswith(LINTERS), item.path != compiling, needs_kernels(item),
        item.path not in long))


def import_share(config: pytest.Config, folder: Path = Path(__file__).parent) -> None:
    """
    Import one of so many test files as there are workers, before all are collected.

    To rewrite the asserts of a file takes longer than to collect its tests, and is kept. Workers
    of a fresh clone that begin at the same file would each rewrite all of them.
    """
    worker, workers = config.workerinput['workerid'], config.workerinput['workercount']
    for path in sorted(folder.rglob('test_*.py'))[int(worker.removeprefix('gw'))::workers]:
        # What cannot be imported is reported, or skipped, when it is collected.
        with suppress(Exception, pytest.skip.Exception, pytest.fail.Exception):
            import_module('.'.join(path.relative_to(folder.parent).with_suffix('').parts))
