"""The kernels of a run from the cache."""

import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

import isa_ros
import pytest

PACKAGES = Path(isa_ros.__file__).parents[1]
START = """
from numba.core.event import install_recorder
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.run.warm_up import warmed_up
import isa_ros
with install_recorder('numba:compile') as compiled:
    for path in shipped(CONFIG).values():
        warmed_up(load_run(path))
from isa_ros.actuator.kernel import actuator_tick
print(isa_ros.__file__, [event.data['dispatcher'].__name__ for _, event in compiled.buffer],
      bool(actuator_tick.stats.cache_hits))
"""


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Return a copy of the package in which all lines and docstrings are others."""
    for name in ('isa_ros', 'msg_adapters'):
        shutil.copytree(PACKAGES / name, tmp_path / name,
                        ignore=shutil.ignore_patterns('__pycache__'))
    shutil.copytree(PACKAGES / 'config', tmp_path / 'config')
    shutil.copy(PACKAGES / 'package.xml', tmp_path)
    for file in tmp_path.rglob('*.py'):
        text = file.read_text()
        file.write_text('# A remark.\n\n' + re.sub(r'"""(?=[A-Z])', '"""Edited: ', text))
    return tmp_path


def test_a_copy_with_other_words_compiles_nothing(compiled_kernels: None, copy: Path) -> None:
    """Nor does a second start: a version of numba that cannot load what it kept shows here."""
    done = subprocess.run(
        [sys.executable, '-c', START], cwd=copy, env=os.environ | {'PYTHONPATH': str(copy)},
        capture_output=True, text=True, timeout=300.0)
    assert (done.stdout, done.stderr) == (f'{copy}/isa_ros/__init__.py [] True\n', '')
