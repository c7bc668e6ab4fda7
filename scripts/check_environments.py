"""
Install the wheel with the oldest and the newest versions that it allows, and try it there.

    python -m scripts.check_environments                     # each Python that the host has
    python -m scripts.check_environments --python 3.12 --versions lowest
    python -m scripts.check_environments --write             # the table of docs/installing.md too

Needs uv (`pip install uv`) and a commit of what is to be tried. A row has the versions that were
installed, and how long each check took:

- command: `isa --version` and `isa params leg.yaml`
- leg: a drop from Python, without ROS; its digest is that of the first row
- replays: the golden bags are replayed bit for bit, with ROS from wheels
- analysis: a report of one, and a validation that compiles, with scipy's solvers and figures
- doors: the packages of the extras are installed, as old or new, and their modules imported

The kernels are those of `python -m scripts.make_kernels` if the checkout has them, else compiled.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
import shutil
import sys
import tempfile

from isa_ros.text.marked import with_parts
from isa_ros.text.table import aligned, markdown
from scripts.environments.environment import (
    CommandResult, Environment, LOWEST, needed, NEWEST, outcome)
from scripts.environments.interpreters import find, PYTHONS

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / 'docs' / 'installing.md'
SHOWN = ('numpy', 'scipy', 'numba', 'matplotlib', 'mcap')
HEADER = ['Python', 'versions', *SHOWN, 'command', 'leg', 'replays', 'analysis', 'doors']
DOORS = {'canopen': 'canopen, can, msgpack', 'ethercat': 'pysoem', 'mujoco': 'isa_ros.mujoco',
         'pinocchio': 'pinocchio'}
"""What an extra is there for, as an import has it."""
LEG = """
import hashlib, sys
import isa_ros
result = isa_ros.load('leg', 'drop').simulate()
assert 'rclpy' not in sys.modules and 'sensor_msgs' not in sys.modules
digest = hashlib.sha256()
for name in sorted(result.units):
    digest.update(name.encode() + result[name].tobytes())
print(digest.hexdigest())
"""


def wheel_of(commit_of: Path, folder: Path) -> Path:
    """Return a wheel of the last commit, with libraries of the checkout; raises OSError."""
    clone = folder / 'clone'
    done = outcome(['git', 'clone', '--quiet', str(commit_of), str(clone)], folder, 300.0)
    if done.is_good:
        for library in (commit_of / 'isa_ros' / 'kernels').glob('*.so'):
            (clone / 'isa_ros' / 'kernels').mkdir(exist_ok=True)
            shutil.copy(library, clone / 'isa_ros' / 'kernels')
        done = outcome(
            ['uv', 'build', '--quiet', '--wheel', '--out-dir', str(folder), str(clone)], folder,
            600.0)
    if not done.is_good:
        raise OSError(None, done.last_line)
    return next(folder.glob('*.whl'))


def ros_packages(requirements: Path) -> list[str]:
    """Return the wheels of ROS that the requirements name at their top."""
    return [line for line in requirements.read_text(encoding='utf-8').splitlines()
            if line.startswith('ros-jazzy-')]


def checks(environment: Environment, wheel: Path) -> Iterator[tuple[str, CommandResult]]:
    """Yield each check with its outcome; that of the leg prints its digest."""
    isa, install = partial(environment.run, 'isa'), environment.install
    bags = [path.parent for path in sorted((ROOT / 'tests' / 'golden').glob('*/metadata.yaml'))]
    yield 'command', in_turn([partial(isa, '--version'), partial(isa, 'params', 'leg.yaml')])
    yield 'leg', environment.run('python', '-c', LEG)
    yield 'replays', in_turn([
        partial(install, ros_packages(ROOT / 'requirements.txt')),
        *(partial(isa, 'replay', bag) for bag in bags)])
    yield 'analysis', in_turn([
        partial(isa, 'report', bags[0], '--out', 'report'),
        partial(isa, 'validate', '--only', 'valve_flow.ullv_flow_2_ma', '--out', 'validated')])
    yield 'doors', in_turn([
        step for extra, modules in DOORS.items() for step in (
            partial(install, needed(wheel, extra)),
            partial(environment.run, 'python', '-c', f'import {modules}'))])


def in_turn(steps: Sequence[Callable[[], CommandResult]]) -> CommandResult:
    """Run steps until one fails; return what the last one printed, and the time of all."""
    seconds, done = 0.0, CommandResult(True, 0.0, '')
    for step in steps:
        done = step()
        seconds += done.seconds
        if not done.is_good:
            break
    return done._replace(seconds=seconds)


def row(minor: str, versions: str, wheel: Path, folder: Path, digests: set[str]) -> list[str]:
    """Return a row of the table; what failed is printed. ``digests`` are those of the legs."""
    python = find(minor)
    if python is None:
        return [minor, versions, *['-'] * (len(HEADER) - 3), 'no interpreter']
    environment = Environment(folder / f'{minor}-{versions}', python, versions)
    made = environment.make(wheel)
    cells: list[str] = []
    if not made.is_good:
        print(f'{minor} {versions}: {made.output}', file=sys.stderr)
        return [minor, versions, *['-'] * (len(HEADER) - 3), 'not installed']
    installed = [environment.version_of(package) for package in SHOWN]
    for name, done in checks(environment, wheel):
        if name == 'leg' and done.is_good:
            digests.add(done.last_line)
            done = done._replace(is_good=len(digests) == 1)
        cells.append(f'{done.seconds:.0f} s' if done.is_good else '**failed**')
        if not done.is_good:
            print(f'{minor} {versions}, {name}: {done.output}', file=sys.stderr)
    return [minor, versions, *installed, *cells]


def main(arguments: Sequence[str]) -> int:
    """Print the table, and return 0 if nothing failed."""
    parser = argparse.ArgumentParser(prog='python -m scripts.check_environments')
    parser.add_argument('--python', nargs='+', default=PYTHONS, metavar='3.N')
    parser.add_argument('--versions', nargs='+', default=(LOWEST, NEWEST),
                        choices=(LOWEST, NEWEST))
    parser.add_argument('--write', action='store_true', help='the table of docs/installing.md')
    given = parser.parse_args(arguments)
    if shutil.which('uv') is None:
        print('check_environments: uv: not found; pip install uv', file=sys.stderr)
        return 2
    digests: set[str] = set()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            wheel = wheel_of(ROOT, folder)
        except OSError as error:
            print(f'check_environments: no wheel: {error.strerror}', file=sys.stderr)
            return 3
        rows = [row(minor, versions, wheel, folder, digests)
                for minor in given.python for versions in given.versions]
    print('\n'.join(aligned([HEADER, *rows])))
    if given.write:
        page = PAGE.read_text(encoding='utf-8')
        PAGE.write_text(
            with_parts(page, {'environments': markdown([HEADER, *rows])}), encoding='utf-8')
    return int(any(cell in ('**failed**', 'not installed') for cells in rows for cell in cells))


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
