"""Layers of imports. The contract is in pyproject.toml."""

from pathlib import Path
import subprocess
import sys

import pytest
from tests.locks import locked

pytest.importorskip('importlinter')
ROOT = Path(__file__).parents[2]


@pytest.mark.linter
def test_the_import_contract_is_kept() -> None:
    """Lower layers import neither ROS, nor each other, nor the layers above."""
    program = 'from importlinter.cli import lint_imports_command; lint_imports_command()'
    with locked(ROOT / 'pyproject.toml'):  # its cache is the clone's
        result = subprocess.run(
            [sys.executable, '-c', program],
            cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
