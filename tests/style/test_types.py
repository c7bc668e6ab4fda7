"""Types: mypy --strict on all packages, relaxed for kernels only (pyproject.toml)."""

from pathlib import Path
import subprocess
import sys

import pytest
from tests.locks import locked

pytest.importorskip('mypy')
ROOT = Path(__file__).parents[2]


@pytest.mark.linter
@pytest.mark.slow
def test_mypy_strict_finds_nothing() -> None:
    """The configuration and the packages are in pyproject.toml."""
    with locked(ROOT / 'pyproject.toml'):  # its cache is the clone's
        result = subprocess.run(
            [sys.executable, '-m', 'mypy'], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
