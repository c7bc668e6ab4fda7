"""
Build and test a clone of the last commit as colcon does it in a workspace of ROS.

    python -m scripts.check_colcon                          # with all tests
    python -m scripts.check_colcon tests/text -m "not slow" # with what pytest is given

Neither apt nor a sourced ROS is needed: colcon comes from PyPI, to an environment of its own above
the one that runs this, which has ROS as wheels. What it cannot show: that `rosdep` finds all
packages on Ubuntu, and that they work there.
"""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
import sys
import sysconfig
import tempfile

from scripts.environments.environment import CommandResult, outcome

ROOT = Path(__file__).resolve().parents[1]
COLCON = 'colcon-common-extensions==0.3.0'
SHARE = ('config/leg.yaml', 'layouts/leg.pj3.xml', 'launch/leg.launch.py', 'package.xml',
         'rviz/leg.rviz', 'urdf/hyq_real_leg.urdf')
"""A file of each folder below share/isa_ros."""
TOLD = ('sourced', 'colcon test-result')
"""Steps whose last line is printed."""
SOURCED = ' && '.join([
    '. install/setup.sh', 'cd /', *(
        f'test -f "$COLCON_PREFIX_PATH/isa_ros/share/isa_ros/{name}"' for name in SHARE),
    'python3 -c "import isa_ros; print(isa_ros.__file__)" | grep "^$COLCON_PREFIX_PATH/"',
    'isa --version'])


class Workspace:
    """A workspace with a clone, and the environment with colcon, below a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._bin = folder / 'colcon' / 'bin'

    def environment(self) -> CommandResult:
        """Make the environment; what the one that runs this has is there too."""
        made = self._do([sys.executable, '-m', 'venv', str(self._bin.parent)], 300.0)
        if not made.is_good:
            return made
        site = next(self._bin.parent.glob('lib/python3*/site-packages'))
        (site / 'above.pth').write_text(sysconfig.get_path('purelib') + '\n', encoding='utf-8')
        return self._do(
            [str(self._bin / 'python'), '-m', 'pip', 'install', '--quiet',
             '--disable-pip-version-check', COLCON], 600.0)

    def clone(self) -> CommandResult:
        """Clone the last commit of the checkout."""
        return self._do(
            ['git', 'clone', '--quiet', str(ROOT), str(self._folder / 'src' / 'isa_ros')], 300.0)

    def colcon(self, *arguments: str, timeout: float = 7200.0) -> CommandResult:
        """Run colcon in the workspace."""
        return self._do([str(self._bin / 'colcon'), *arguments], timeout)

    def sourced(self) -> CommandResult:
        """Run the command of the sourced workspace, and look for shared files."""
        return self._do(['sh', '-c', SOURCED], 300.0)

    def _do(self, command: Sequence[str], timeout: float) -> CommandResult:
        path = f'{self._bin}:/usr/local/bin:/usr/bin:/bin'
        return outcome(command, self._folder, timeout, PATH=path)


def steps(
        workspace: Workspace,
        tests: Sequence[str]) -> list[tuple[str, Callable[[], CommandResult]]]:
    """Return what is done, in this order, by name."""
    return [
        ('environment', workspace.environment),
        ('clone', workspace.clone),
        ('colcon build', partial(workspace.colcon, 'build')),
        ('sourced', workspace.sourced),
        ('colcon test', partial(
            workspace.colcon, 'test', '--return-code-on-test-failure',
            *(('--pytest-args', *tests) if tests else ()))),
        ('colcon test-result', partial(workspace.colcon, 'test-result', '--verbose'))]


def main(tests: Sequence[str]) -> int:
    """Print a line for each step, the output of one that fails, and return 0 if none does."""
    with tempfile.TemporaryDirectory() as folder:
        for name, step in steps(Workspace(Path(folder)), tests):
            done = step()
            if not done.is_good:
                print(f'{name}: failed after {done.seconds:.0f} s\n{done.output}')
                return 1
            said = f', {done.last_line.strip()}' if name in TOLD else ''
            print(f'{name}: {done.seconds:.0f} s{said}', flush=True)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
