"""Kernels in a library give the recorded bytes, in a process that has no compiler."""

import json
import os
from pathlib import Path
import subprocess
import sys

import pytest
from tests.golden.message_digests import FILE

ROOT = Path(__file__).parents[2]
RUNS = ('leg.yaml drop.yaml', 'quadruped.yaml quadruped_stand.yaml',
        'crane_circuit.yaml crane_circuit.yaml', 'rig_rotary.yaml wheel_sine.yaml',
        'rig_temperature.yaml temperature.yaml', 'rig_hoses.yaml idle')
PROGRAM = """
import json, sys
from pathlib import Path
sys.modules['numba'] = sys.modules['llvmlite'] = None
from isa_ros.core import kernel_library
kernel_library.SHIPPED = Path(sys.argv[1])
from tests.golden.message_digests import digests, pairs
scenarios = pairs()
print(json.dumps({name: digests(scenarios[name]) for name in sys.argv[2:]}))
print(*[name for name in sys.modules if name.startswith(('scipy', 'numba.', 'llvmlite.'))])
"""
COMMANDS = ('step isa_v5 --loop force', 'replay tests/golden/rotor_step')
COMMAND = """
import sys
from pathlib import Path
class Forbidden:
    def find_spec(self, name, *others):
        if name in ('numba', 'llvmlite', 'matplotlib'):
            raise AssertionError(f'{name} is loaded')
sys.meta_path.insert(0, Forbidden())
from isa_ros.core import kernel_library
kernel_library.SHIPPED = Path(sys.argv.pop(1))
from isa_ros.cli.main import main
sys.exit(main())
"""


def paths(out):
    """Return where the libraries for processors of this kind are."""
    from isa_ros.core.kernel_library import own_targets
    return [out / f'{name}.so' for name in own_targets()]


def are_new(made):
    """Return whether libraries are there, made after the last change of what they are made of."""
    sources = [path for folder, pattern in (
        ('isa_ros', '*.py'), ('config', '*.yaml'), ('scripts', '*kernel*.py'))
        for path in (ROOT / folder).rglob(pattern)]
    changed = max(path.stat().st_mtime for path in sources)
    return all(path.exists() and path.stat().st_mtime > changed for path in made)


@pytest.fixture(scope='module')
def libraries(tmp_path_factory):
    """Return a directory with the libraries for processors of this kind: those of `./isa test`."""
    from isa_ros.core.kernel_library import SHIPPED
    if are_new(paths(SHIPPED)):
        return SHIPPED
    out = tmp_path_factory.mktemp('kernels')
    made = subprocess.run(
        [sys.executable, '-m', 'scripts.make_kernels', '--own', '--out', str(out)],
        cwd=ROOT, env={**os.environ, 'PYTHONPATH': str(ROOT)}, capture_output=True, text=True,
        timeout=900.0)
    assert made.returncode == 0, made.stderr
    for line in made.stdout.splitlines()[-len(paths(out)):]:
        assert ' of ' in line and 'left out' not in line
    return out


@pytest.mark.slow
@pytest.mark.golden
def test_the_recorded_bytes_without_a_compiler(libraries, tmp_path):
    """Each library of this machine: that of the oldest processor too."""
    expected = json.loads(FILE.read_text())
    for path in paths(libraries):
        only = tmp_path / path.stem
        only.mkdir()
        (only / _own_name()).symlink_to(path)
        done = subprocess.run(
            [sys.executable, '-W', 'ignore', '-c', PROGRAM, str(only), *RUNS], cwd=ROOT,
            env={**os.environ, 'PYTHONPATH': str(ROOT), 'NUMBA_CACHE_DIR': str(tmp_path / 'none')},
            capture_output=True, text=True, timeout=600.0)
        assert done.returncode == 0, done.stderr
        found, loaded = done.stdout.splitlines()
        assert json.loads(found) == {name: expected[name] for name in RUNS}, path.name
        assert loaded == ''


@pytest.mark.slow
@pytest.mark.parametrize('command', COMMANDS)
def test_a_command_compiles_nothing(libraries, command):
    """What a new user types: measures one actuator, or opens a bag."""
    done = subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', COMMAND, str(libraries), *command.split()],
        cwd=ROOT, env={**os.environ, 'PYTHONPATH': str(ROOT)}, capture_output=True, text=True,
        timeout=100.0)
    assert done.returncode == 0, done.stderr


def _own_name() -> str:
    """Return the name of the library that this machine loads first."""
    from isa_ros.core.kernel_library import own_targets
    return f'{own_targets()[0]}.so'
