"""Lely's dcfgen, as ros2_canopen runs it: strict, and here with each of its warnings an error."""

from importlib.util import find_spec
from pathlib import Path
import subprocess
import sys

import pytest

needs_dcfgen = pytest.mark.skipif(
    find_spec('dcfgen') is None, reason='needs dcfgen: pip install dcf-tools')
# The one of setuptools about pkg_resources is not about a file.
_WARNINGS = ('-W', 'error::UserWarning', '-W', 'ignore:pkg_resources:UserWarning')


def dcfgen(bus: Path) -> list[str]:
    """Write what a master needs beside a bus.yml; return the SDO writes that it configures."""
    found = subprocess.run(
        [sys.executable, *_WARNINGS, '-c', 'from dcfgen.cli import main; main()',
         '-v', '-d', bus.parent, bus], capture_output=True, text=True)
    assert (found.returncode, found.stderr) == (0, ''), found.stderr
    return found.stdout.splitlines()
