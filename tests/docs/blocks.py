"""
The blocks of a page, run in the order in which a reader would.

``bash`` blocks are run by a shell in which `./isa` and `python` are those of this environment,
``python`` blocks share one namespace. A block of any kind whose first line is a comment with the
name of a file is written to it, and a ``yaml`` block to NAME.yaml. A ``text`` block is the output
of the block above it, in which ``...`` stands for anything. Indented lines that begin with a
command are a block ``command`` of the shell.
"""

from collections.abc import Collection, Iterator
import contextlib
from doctest import ELLIPSIS, NORMALIZE_WHITESPACE, OutputChecker
import io
import os
from pathlib import Path
import signal
import subprocess
import sys

from scripts.page_blocks import Block, blocks_of, first_line, is_part, own_file

ROOT = Path(__file__).parents[2]
TIMEOUT_S = 300.0


def run(page: str, folder: Path, left_out: Collection[str] = (), has_parts: bool = False) -> int:
    """
    Run the blocks of a page in a folder; return how many were run or written.

    Blocks whose first line is in ``left_out`` are not; nor parts of files, where a page has them.

    Raises
    ------
    AssertionError
        A block is of no known kind, failed, or printed something else.

    """
    (folder / 'isa').write_text(f'#!/bin/sh\nexec {sys.executable} -m isa_ros "$@"\n')
    (folder / 'isa').chmod(0o755)
    names: dict[str, object] = {}
    printed: str | None = None
    count = 0
    for block in blocks_of(page):
        if first_line(block) in left_out or (has_parts and is_part(block)):
            continue
        if block.kind == 'text':
            assert printed is not None, f'line {block.line}: an output without a block above it'
            _compare(block, printed)
            printed = None
            continue
        count += 1
        printed = _result(block, folder, names)
    return count


def _result(block: Block, folder: Path, names: dict[str, object]) -> str | None:
    """Return what a block prints; None: it is a file."""
    if name := own_file(block):
        (folder / name).write_text(block.text)
        return None
    if block.kind in ('bash', 'command'):
        return _of_shell(block, folder)
    assert block.kind == 'python', f'line {block.line}: a block of {block.kind} cannot be run'
    with _within(folder), contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(block.text, f'line {block.line} of the page', 'exec'), names)
    return out.getvalue()


def environment(folder: Path) -> dict[str, str]:
    """Return that of a page's commands: `isa`, `./isa` and `python` are those of this test."""
    path = os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ['PATH']])
    return {**os.environ, 'PYTHONPATH': str(ROOT), 'ROOT': str(ROOT), 'PATH': path,
            'ROS_LOG_DIR': str(folder / 'log')}


def _of_shell(block: Block, folder: Path) -> str:
    """Return what the commands print; what they leave in the background is ended."""
    out = folder / 'printed.txt'    # not a pipe, which a process in the background would hold
    with out.open('w+') as printed:
        shell = subprocess.Popen(
            ['bash', '-euo', 'pipefail', '-c', block.text], cwd=folder, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=printed, stderr=subprocess.PIPE, text=True,
            env=environment(folder))
        try:
            code = shell.wait(TIMEOUT_S)
        except subprocess.TimeoutExpired:
            code = None
        with contextlib.suppress(ProcessLookupError):
            os.killpg(shell.pid, signal.SIGKILL)
        errors = shell.communicate()[1]
    assert code is not None, f'line {block.line}: not finished after {TIMEOUT_S:g} s'
    text = out.read_text()
    assert code == 0, f'line {block.line}: {text}{errors}'
    return text


def _compare(block: Block, printed: str) -> None:
    is_as_shown = OutputChecker().check_output(
        block.text, printed, ELLIPSIS | NORMALIZE_WHITESPACE)
    assert is_as_shown, f'line {block.line}: printed was\n{printed}'


@contextlib.contextmanager
def _within(folder: Path) -> Iterator[None]:
    """Let Python stand in a folder and import its files, and forget them afterwards."""
    before, known = Path.cwd(), set(sys.modules)
    os.chdir(folder)
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))
        os.chdir(before)
        for name in set(sys.modules) - known:
            if str(getattr(sys.modules[name], '__file__', None) or '').startswith(str(folder)):
                del sys.modules[name]
