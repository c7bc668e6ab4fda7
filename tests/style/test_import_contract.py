"""Layers: who may import whom. The contract stands in pyproject.toml."""

from pathlib import Path
import subprocess
import sys

import pytest
from tests.locks import locked

pytest.importorskip('importlinter')
ROOT = Path(__file__).parents[2]


@pytest.mark.linter
def test_the_import_contract_is_kept() -> None:
    """Layers below know nothing of ROS, of each other, or of the layers above."""
    program = 'from importlinter.cli import lint_imports_command; lint_imports_command()'
    with locked(ROOT / 'pyproject.toml'):  # its cache is the clone's
        result = subprocess.run(
            [sys.executable, '-c', program],
            cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
