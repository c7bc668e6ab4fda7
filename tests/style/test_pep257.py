"""The docstring style that `colcon test` checks."""

from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).parents[2]
CODE = ('isa_ros', 'msg_adapters', 'benchmarks', 'launch', 'scripts', 'tests', 'setup.py')


@pytest.mark.linter
@pytest.mark.pep257
def test_pep257_finds_nothing() -> None:
    """As ament_pep257 configures it; in a separate process, since it logs every file."""
    program = 'import gc, sys; gc.disable(); from ament_pep257.main import main; sys.exit(main())'
    result = subprocess.run(
        [sys.executable, '-c', program, *(p for p in CODE if (ROOT / p).exists())],
        cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
