"""
Follow the pages of docs/ word for word from a clean clone: what a new user does, with times.

    python -m scripts.first_tasks DIR [--only N ...] [--environment PATH] [--write]

clones this repository into DIR/isa_ros and does there what `scripts/first_tasks_list.py` names:
the commands and blocks of the pages, and nothing else. The first one makes the environment, unless
one is given. `--write` puts the table into docs/first_tasks.md. The exit code is 1 if a task
fails.
"""

from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
import os
from pathlib import Path
import platform
import shutil
import signal
import subprocess
import sys
import time
from typing import NamedTuple

from isa_ros.core.atomic_file import replace_file
from isa_ros.text.marked import with_parts
from isa_ros.text.table import aligned, markdown
from scripts.first_tasks_list import COMMAND, Task, TASKS
from scripts.page_blocks import Block, blocks_of, first_line, own_file

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / 'docs' / 'first_tasks.md'
KERNELS = ROOT / 'isa_ros' / 'kernels'
PART = 'tasks'
LONGEST_S = 1200.0
HEADER = ('', 'task', 'page', 'seen', 'time, s')


class Done(NamedTuple):
    """A task after it was followed."""

    number: int
    task: Task
    seconds: float
    failure: str
    """Why it failed; '' if it did not."""


def steps_of(task: Task, docs: Path) -> Iterator[Block]:
    """
    Yield the blocks and commands of a task, as its page has them.

    Raises
    ------
    LookupError
        The page does not have a block with such a first line, or such a command.

    """
    page = (docs / f'{task.page}.md').read_text(encoding='utf-8')
    blocks = [block for block in blocks_of(page) if block.kind != 'text']
    if not task.steps:
        yield from blocks
    for step in task.steps:
        if step.startswith(COMMAND):
            words = step.removeprefix(COMMAND)
            if words not in page:
                raise LookupError(f'{task.page}.md has no command {words}')
            yield Block('bash', f'{words}\n', 0)
            continue
        found = next((block for block in blocks if first_line(block) == step), None)
        if found is None:
            raise LookupError(f'{task.page}.md has no block {step}')
        yield found


def followed(task: Task, clone: Path) -> str:
    """Do a task in a clone; return why it failed, or ''."""
    printed, python = '', ''
    service = _start(task.service, clone) if task.service else None
    try:
        for block in steps_of(task, clone / 'docs'):
            if name := own_file(block):
                (clone / name).write_text(block.text, encoding='utf-8')
                continue
            if block.kind == 'python':      # its names are those of the blocks before it
                python += block.text
                code, text = _run([str(clone / '.venv' / 'bin' / 'python'), '-c', python], clone)
            else:
                code, text = _run(['bash', '-euo', 'pipefail', '-c', block.text], clone)
            printed += text
            if code:
                return f'{first_line(block)}: exit code {code}: {text.strip()[-300:]}'
    except LookupError as error:
        return str(error)
    finally:
        if service:
            os.killpg(service.pid, signal.SIGKILL)
            service.wait()
    if task.shows not in printed:
        return f'{task.shows!r} was not printed: {printed.strip()[-300:]}'
    if task.makes and not (clone / task.makes).exists():
        return f'{task.makes} was not made'
    return ''


def _environment(clone: Path) -> dict[str, str]:
    """Return that of a shell in which the clone's environment is active, as README.md has it."""
    own = {name: value for name, value in os.environ.items() if name != 'PYTHONPATH'}
    return {**own, 'PATH': os.pathsep.join(
        [str(clone / '.venv' / 'bin'), str(clone), os.environ['PATH']])}


def _start(command: str, clone: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        ['bash', '-c', f'exec {command}'], cwd=clone, env=_environment(clone),
        start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _run(command: Sequence[str], clone: Path) -> tuple[int, str]:
    """Return exit code and output; what is left in the background is ended."""
    with (clone / 'printed.txt').open('w+') as printed:
        started = subprocess.Popen(
            command, cwd=clone, env=_environment(clone), start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=printed, stderr=subprocess.STDOUT)
        try:
            code = started.wait(LONGEST_S)
        except subprocess.TimeoutExpired:
            code = 124
        try:
            os.killpg(started.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        started.wait()
        printed.seek(0)
        return code, printed.read()


def made_clone(folder: Path, environment: Path | None) -> Path:
    """
    Clone this repository into a folder; an environment is linked if one is given.

    Then the clone has the libraries of kernels of this checkout, too, which `./isa` would make.
    """
    clone = folder / 'isa_ros'
    subprocess.run(['git', 'clone', '--quiet', '--depth', '1', f'file://{ROOT}', str(clone)],
                   check=True)
    if environment:
        (clone / '.venv').symlink_to(environment.resolve())
        if KERNELS.is_dir():
            shutil.copytree(KERNELS, clone / KERNELS.relative_to(ROOT),
                            ignore=shutil.ignore_patterns('.*'))    # what is being made
    return clone


def rows(done: Sequence[Done]) -> list[tuple[str, ...]]:
    """Return the table: number, task, page, what was seen, time in s."""
    return [HEADER, *((
        str(own.number), own.task.title, own.task.page,
        own.failure or own.task.shows or own.task.makes, f'{own.seconds:.1f}') for own in done)]


def write(done: Sequence[Done]) -> None:
    """Write the table into its page."""
    linked = [HEADER, *((number, title, f'[{page}]({page}.md)', f'`{seen}`', seconds)
                        for number, title, page, seen, seconds in rows(done)[1:])]
    where = (f'{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[2]:.1f} '
             f'in the last 15 minutes, Python {platform.python_version()}; in all '
             f'{sum(own.seconds for own in done) / 60:.0f} minutes.')
    page = with_parts(PAGE.read_text(encoding='utf-8'), {
        PART: [where, '', *markdown(linked, 'llllr')]})
    replace_file(PAGE, page.encode(), is_durable=False)


def main(arguments: Sequence[str]) -> int:
    """Follow the tasks; print each with its time."""
    parser = ArgumentParser(prog='first_tasks')
    parser.add_argument('folder', type=Path)
    parser.add_argument('--only', type=int, nargs='+', default=range(1, len(TASKS) + 1))
    parser.add_argument('--environment', type=Path)
    parser.add_argument('--write', action='store_true')
    options = parser.parse_args(arguments)
    clone = made_clone(options.folder, options.environment)
    done = []
    for number in options.only:
        began = time.monotonic()
        failure = followed(TASKS[number - 1], clone)
        done.append(Done(number, TASKS[number - 1], time.monotonic() - began, failure))
        print(f'{number}: {failure or "done"}', file=sys.stderr, flush=True)
    print('\n'.join(aligned(rows(done), 'rlllr')))
    if options.write:
        write(done)
    return int(any(own.failure for own in done))


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
