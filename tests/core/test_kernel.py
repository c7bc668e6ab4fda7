"""The cache of compiled kernels."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from isa_ros.core import kernel as kernels
from isa_ros.core import kernel_cache
from isa_ros.core.kernel import kernel, part_of_kernel
import pytest


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


def test_versions_for_other_types_are_files_of_their_own(make):
    compiled = make('own')
    assert (compiled(3), compiled(1.5)) == (6, 3.0)
    loaded = make('own')
    assert (loaded(3), loaded(1.5)) == (6, 3.0)
    assert sum(loaded.stats.cache_hits.values()) == 2


@pytest.mark.parametrize('damage', [
    lambda data, other: b'', lambda data, other: data[:-1], lambda data, other: other,
    lambda data, other: data[:50] + bytes([data[50] ^ 1]) + data[51:]])
def test_a_damaged_or_renamed_file_is_compiled_again(make, tmp_path, damage):
    compiled = make('own')
    assert (compiled(3), compiled(1.5)) == (6, 3.0)
    first, second = sorted((tmp_path / 'own').iterdir())
    one, two = first.read_bytes(), second.read_bytes()
    first.write_bytes(damage(one, two))
    second.write_bytes(damage(two, one))
    loaded = make('own')
    assert (loaded(3), loaded(1.5)) == (6, 3.0)
    assert sum(loaded.stats.cache_misses.values()) == 2
    assert len({first.read_bytes(), second.read_bytes()}) == 2


def test_a_numba_that_cannot_load_what_it_kept_is_one_line(make, monkeypatch, capsys):
    """Silence would mean that every start compiles."""
    assert make('own')(3) == 6
    monkeypatch.setattr(kernel_cache, 'compile_result', lambda **_: {}['missing'])
    kernel_cache.say_not_kept.cache_clear()
    loaded = make('own')
    assert loaded(3) == 6
    assert sum(loaded.stats.cache_misses.values()) == 1
    line, = capsys.readouterr().err.splitlines()
    assert "loading them fails with KeyError('missing'): every start compiles them" in line


def test_without_compiling_a_kernel_is_the_function(monkeypatch):
    monkeypatch.setattr(kernels, 'IS_COMPILED', False)
    assert kernel(twice) is twice


@part_of_kernel
def thrice(x):
    return x + x + x


@kernel
def with_part(x):
    return thrice(x) + 1


def test_a_part_is_compiled_with_its_kernel_and_alone_only_where_python_calls_it():
    assert with_part(3) == 10
    assert thrice.signatures == []
    assert thrice(2.5) == 7.5
    assert len(thrice.signatures) == 1
