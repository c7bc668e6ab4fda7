"""What tests of kernels share."""

from isa_ros.core import kept_objects, large_kernels
import pytest


@pytest.fixture
def directory(tmp_path, monkeypatch):
    """Return an empty directory in which objects are kept; kernels of two are large."""
    own = tmp_path / 'kept'
    monkeypatch.setattr(kept_objects, 'CACHE', own)
    monkeypatch.setattr(kept_objects, 'READ', (own,))
    monkeypatch.setattr(large_kernels, 'MANY', 2)
    assert 'tests' in large_kernels.PACKAGES     # by tests/conftest.py
    monkeypatch.setattr(large_kernels, 'is_kept', lambda kernel: False)
    large_kernels._made.cache_clear()
    return own
