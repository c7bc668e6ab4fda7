"""Pages with parts of files among their blocks: what can be run is run, the rest is listed."""

from collections.abc import Iterator
from contextlib import contextmanager, ExitStack, suppress
import os
from pathlib import Path
import re
import shlex
import signal
import subprocess

from isa_ros.cli.main import make_parser
import pytest
from scripts.page_blocks import blocks_of, first_line, is_part
from tests.docs.blocks import environment, run
from tests.docs.older_pages import BEFORE, NOT_RUN
from tests.docs.test_pages_run import PAGES
from tests.ros.domains import held_domain
from tests.ros.started import wait_for
import yaml

DOCS = Path(__file__).parents[2] / 'docs'
MINUTES_LONG = 'loops', 'quadruped'
OTHER_TESTS = {'run_file': 'tests/docs/test_run_file.py'}
"""Pages whose only blocks are files that another test loads."""


def text_of(page: str) -> str:
    return (DOCS / f'{page}.md').read_text(encoding='utf-8')


@contextmanager
def service(command: str, ready: str, folder: Path) -> Iterator[None]:
    """Run a command until the end, from when another one succeeds."""
    started = subprocess.Popen(
        ['bash', '-c', f'exec {command}'], cwd=folder, env=environment(folder),
        start_new_session=True, stdout=subprocess.DEVNULL)
    try:
        wait_for(lambda: subprocess.run(
            ready, shell=True, cwd=folder, env=environment(folder), capture_output=True,
            check=False).returncode == 0, f'{command} to be ready')
        yield
        assert started.poll() is None, f'{command} has ended'
    finally:
        with suppress(ProcessLookupError):
            os.killpg(started.pid, signal.SIGKILL)
        started.wait()


@pytest.mark.ros
@pytest.mark.parametrize('page', [pytest.param(
    page, marks=pytest.mark.long if page in MINUTES_LONG else pytest.mark.slow)
    for page in sorted(BEFORE)])
def test_what_can_be_run_runs(
        page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = BEFORE[page]
    blocks = f'```bash\n{before.shell}\n```\n' if before.shell else ''
    if before.python:
        blocks += f'```python\n{before.python}\n```\n'
    with held_domain(monkeypatch), ExitStack() as meanwhile:
        if before.service:
            run(blocks, tmp_path)
            meanwhile.enter_context(service(before.service, before.ready, tmp_path))
            blocks = ''
        run(blocks + text_of(page), tmp_path, NOT_RUN.get(page, ()), has_parts=True)


@pytest.mark.parametrize('page', sorted(path.stem for path in DOCS.glob('*.md')))
def test_every_block_is_run_or_listed_with_its_reason(page: str) -> None:
    """One block for each name, so that a name leaves out no other."""
    names = [first_line(block) for block in blocks_of(text_of(page))
             if not is_part(block) and block.kind != 'text']
    listed = NOT_RUN.get(page, {})
    assert set(listed) <= set(names) and all(names.count(name) == 1 for name in listed)
    assert all(listed.values())
    if page not in PAGES and page not in BEFORE and page not in OTHER_TESTS:
        assert set(names) == set(listed)


_COMMAND = re.compile(r'(?:^|[\s(])(?:\./)?isa (?!test\b)([a-z].*)')
_END = re.compile(r"\s(?:\|\|?|&&?|[12]?>|#)(?:\s|&|$)|[);]|'$")


def commands_of(page: str) -> Iterator[list[str]]:
    """Yield the words of each command `isa` in a page's blocks, run or not."""
    for block in blocks_of(text_of(page)):
        if block.kind in ('bash', 'command'):
            for line in re.split(r'\n| && ', block.text.replace('\\\n', ' ')):
                if found := _COMMAND.search(line):
                    yield shlex.split(_END.split(found[1])[0])


@pytest.mark.parametrize('page', sorted(path.stem for path in DOCS.glob('*.md')))
def test_every_command_has_options_that_there_are(page: str) -> None:
    """Also of those that are not run."""
    for words in commands_of(page):
        assert make_parser().parse_args(words).command, words


def test_there_are_many_commands_and_a_wrong_option_is_noticed() -> None:
    assert sum(len(list(commands_of(path.stem))) for path in DOCS.glob('*.md')) > 120
    with pytest.raises(SystemExit):
        make_parser().parse_args(['bringup', 'leg', '--scenari', 'drop', '--durations', '1'])


def test_the_lists_name_pages() -> None:
    pages = {path.stem for path in DOCS.glob('*.md')}
    assert set(BEFORE) | set(NOT_RUN) | set(PAGES) | set(OTHER_TESTS) <= pages
    assert not set(BEFORE) & set(PAGES)


def test_parts_of_files_are_yaml() -> None:
    """Where a page leaves something out, it writes three dots."""
    count = 0
    for path in sorted(DOCS.glob('*.md')):
        for block in blocks_of(path.read_text(encoding='utf-8')):
            if block.kind == 'yaml':
                count += 1
                text = re.sub(r',? *[.]{3}', '', block.text)
                assert yaml.safe_load(text), f'{path}: {block.line}'
    assert count > 30


def test_a_service_runs_meanwhile_and_is_ended(tmp_path: Path) -> None:
    command = 'bash -c "echo $$ > pid; sleep 300"'
    with service(command, 'test -s pid', tmp_path):
        pid = int((tmp_path / 'pid').read_text())
        assert Path(f'/proc/{pid}').exists()
    wait_for(lambda: not Path(f'/proc/{pid}').exists(), 'the end of the service')
    with pytest.raises(AssertionError, match='true has ended'), service(
            'true', 'sleep 0.2', tmp_path):
        pass
