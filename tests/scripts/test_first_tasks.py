"""The first tasks are on their pages; what fails in one is told; a short form of them."""

from pathlib import Path
import time

import pytest
from scripts import first_tasks
from scripts.first_tasks import Done, followed, main, ROOT, rows, steps_of, write
from scripts.first_tasks_list import Task, TASKS
from tests.ros.domains import held_domain

PAGE = """# A page

```python
value = 6
```

```python
print(7 * value)
```

```text
42
```

    python -c 'print(3)'    # a command

```bash
echo end > made.txt; exit 5
```
"""


def test_there_are_27_and_each_has_something_to_be_seen() -> None:
    assert len(TASKS) == 27 and len({task.title for task in TASKS}) == 27
    assert all(task.shows or task.makes for task in TASKS)


@pytest.mark.parametrize('task', TASKS, ids=[task.title for task in TASKS])
def test_every_step_is_on_its_page(task: Task) -> None:
    """Word for word: a step that is not there is refused."""
    assert [block for block in steps_of(task, ROOT / 'docs') if block.text.strip()]


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """Return a folder as a clone would be, with one page and this environment."""
    (tmp_path / 'docs').mkdir()
    (tmp_path / 'docs' / 'page.md').write_text(PAGE)
    (tmp_path / '.venv').symlink_to(Path(first_tasks.sys.prefix))
    return tmp_path


@pytest.mark.parametrize('steps, shows, makes, failure', [
    (('value = 6', 'print(7 * value)'), '42', '', ''),
    (('value = 6', 'print(7 * value)'), '43', '', "'43' was not printed: 42"),
    (("$ python -c 'print(3)'",), '3', '', ''),
    (("$ python -c 'print(3)'", 'value = 6'), '3', '', ''),
    (("python -c 'print(3)'",), '3', 'not.txt', 'not.txt was not made'),
    (("$ python -c 'print(4)'",), '', '', "page.md has no command python -c 'print(4)'"),
    (('value = 7',), '', '', 'page.md has no block value = 7'),
    ((), '', '', 'echo end > made.txt; exit 5: exit code 5: ')])
def test_a_task_is_done_or_says_why_not(
        steps: tuple[str, ...], shows: str, makes: str, failure: str, clone: Path) -> None:
    assert followed(Task('a', 'page', steps, shows, makes), clone) == failure


def test_a_service_runs_until_the_task_is_done(clone: Path) -> None:
    (clone / 'docs' / 'page.md').write_text(
        '```bash\nuntil [ -s pid ]; do sleep 0.05; done\nkill -0 $(cat pid) && echo runs\n```\n')
    task = Task('a', 'page', (), 'runs', 'pid', 'bash -c "echo \\$\\$ > pid; sleep 300"')
    began = time.monotonic()
    assert followed(task, clone) == ''
    assert time.monotonic() - began < 60.0      # the service alone would take 300 s
    assert not Path(f'/proc/{(clone / "pid").read_text().strip()}').exists()


def test_the_table_has_what_was_seen_or_why_not(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = [Done(3, Task('look', 'tutorial', (), 'at most'), 12.34, ''),
            Done(5, Task('tune', 'loops', (), '', 'tuned.yaml'), 7.0, 'exit code 2')]
    assert rows(done)[1:] == [('3', 'look', 'tutorial', 'at most', '12.3'),
                              ('5', 'tune', 'loops', 'exit code 2', '7.0')]
    page = tmp_path / 'first_tasks.md'
    page.write_text(first_tasks.PAGE.read_text())
    monkeypatch.setattr(first_tasks, 'PAGE', page)
    write(done)
    text = page.read_text()
    assert '| 3 | look | [tutorial](tutorial.md) | `at most` | 12.3 |' in text
    assert 'in all 0 minutes.' in text and text.count('\n| ') == 3


@pytest.mark.slow
@pytest.mark.ros
def test_some_of_them_are_followed_in_a_clone(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    """With environment and libraries of this test; `./isa` would make them."""
    with held_domain(monkeypatch):
        code = main([
            str(tmp_path), '--only', '3', '8', '11', '--environment', first_tasks.sys.prefix])
    printed = capsys.readouterr()
    assert code == 0, printed.out
    assert printed.err == '3: done\n8: done\n11: done\n'
    assert [line.split()[0] for line in printed.out.splitlines()[1:]] == ['3', '8', '11']
    has_libraries = (tmp_path / 'isa_ros' / 'isa_ros' / 'kernels').is_dir()
    assert has_libraries == first_tasks.KERNELS.is_dir()


def test_a_task_that_fails_gives_exit_code_1(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(first_tasks, 'made_clone', lambda folder, environment: folder)
    monkeypatch.setattr(first_tasks, 'followed', lambda task, clone: f'no {task.title}')
    assert main([str(tmp_path), '--only', '2']) == 1
    assert f'2: no {TASKS[1].title}\n' == capsys.readouterr().err


def test_a_user_has_no_path_of_this_checkout(
        clone: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('PYTHONPATH', 'checkout')
    (clone / 'docs' / 'page.md').write_text('```bash\necho "path <${PYTHONPATH:-}>"\n```\n')
    assert followed(Task('a', 'page', (), 'path <>'), clone) == ''
