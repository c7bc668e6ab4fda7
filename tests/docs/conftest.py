"""A copy of the package for each test that extends it."""

from pathlib import Path

import pytest
from tests.docs.patched_copy import PatchedCopy


@pytest.fixture
def copied(tmp_path: Path) -> PatchedCopy:
    """Return a copy of the package."""
    return PatchedCopy(tmp_path)
