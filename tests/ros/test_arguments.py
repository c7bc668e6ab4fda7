"""Command lines of the executables: help, and arguments that are not ROS arguments."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.ros
MODULES = ['isa_ros.programs.actuator', 'isa_ros.programs.coordinator']


def run(module: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Return the result of an executable."""
    return subprocess.run([sys.executable, '-m', module, *arguments],
                          capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize('module', MODULES)
def test_help_says_how_to_use_it_and_starts_nothing(domain, module):
    """Exit code 0."""
    result = run(module, '--help')
    assert (result.returncode, result.stderr) == (0, '')
    assert 'ros2 run isa_ros' in result.stdout


@pytest.mark.parametrize(('arguments', 'named'), [
    (['leg.yaml'], "argument 'leg.yaml' is unknown"),
    (['--ros-args', '-p', 'model'], 'model'),
    (['--ros-args', '--no-such-thing'], '--no-such-thing'),
])
@pytest.mark.parametrize('module', MODULES)
def test_a_wrong_argument_is_refused_in_one_line(domain, module, arguments, named):
    """Exit code 2, no traceback."""
    result = run(module, *arguments)
    assert result.returncode == 2
    assert result.stderr.count('\n') == 1
    assert named in result.stderr
