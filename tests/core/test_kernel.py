"""The cache of compiled kernels."""

from collections.abc import Callable
from pathlib import Path
import threading
from typing import Any

from isa_ros.core import kernel as kernels
from isa_ros.core.kernel import kernel
import numba
import pytest

BLOCKED_S = 0.2  # one that is not kept waiting needs a millisecond


def twice(x):
    return x + x


@pytest.fixture
def make(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[str], Any]:
    """Return a function that makes the kernel `twice` with a cache directory of that name."""
    def kernel_of(directory: str) -> Any:
        monkeypatch.setattr(kernels, 'CACHE', tmp_path / directory)
        return kernel(twice)
    return kernel_of


def test_a_second_process_loads_what_the_first_has_compiled(make):
    assert make('shared')(3) == 6
    other = make('shared')
    assert other(3) == 6
    assert sum(other.stats.cache_hits.values()) == 1


def test_two_processes_that_save_at_once_keep_each_its_own_version(make):
    """One for integers is saved while the other has read the index to add one for floats."""
    compiled = make('own')
    assert (compiled(3), compiled(1.5)) == (6, 3.0)
    integers, floats = compiled.overloads.items()
    second = threading.Thread(target=make('shared')._cache.save_overload, args=integers)
    first = make('shared')._cache
    write_index = first._cache_file._save_index

    def save_index(overloads: dict[Any, str]) -> None:
        second.start()
        second.join(BLOCKED_S)
        write_index(overloads)
    first._cache_file._save_index = save_index
    first.save_overload(*floats)
    second.join()
    loaded = make('shared')
    assert (loaded(3), loaded(1.5)) == (6, 3.0)
    assert sum(loaded.stats.cache_hits.values()) == 2


def test_without_compiling_a_kernel_is_the_function(monkeypatch):
    monkeypatch.setattr(numba.config, 'DISABLE_JIT', True)
    assert kernel(twice) is twice
