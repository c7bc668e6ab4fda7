"""Every command and code block of these pages can be run as printed, with what it prints."""

from contextlib import nullcontext
from pathlib import Path

from matplotlib.testing.compare import compare_images
import pytest
from scripts.page_blocks import blocks_of
from tests.docs import blocks
from tests.docs.blocks import run
from tests.docs.older_pages import NOT_RUN
from tests.fieldbus.canopen.test_masters import refusal
from tests.ros.domains import held_domain
from tests.ros.started import is_alive, wait_for

DOCS = Path(__file__).parents[2] / 'docs'
PAGES = {
    'c_bus': 5, 'c_controller': 3, 'controller': 9, 'coupling': 1, 'explanation': 1, 'layouts': 1,
    'lesson_pressure': 7, 'lesson_tuning': 11, 'lesson_valve': 5, 'lockstep': 1, 'own_leg': 5,
    'own_load': 4, 'own_valve': 3, 'pump_sizing': 3, 'reproduce': 8, 'signs': 1, 'tutorial': 12}
"""Pages, and how many of their blocks are run or written to a file."""
NAMESPACED = 'c_bus',
"""Pages whose commands make a network namespace."""
LARGEST_DIFFERENCE = 1.0
"""Of a lesson's figure, root mean square of 256 levels; a curve elsewhere gives 5 and more."""


@pytest.mark.slow
@pytest.mark.ros
@pytest.mark.parametrize('page', sorted(PAGES))
def test_a_page_runs_as_printed(
        page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if page in NAMESPACED and (reason := refusal('ip', 'link', 'set', 'lo', 'up')):
        pytest.skip(f'no network namespace: {reason}')
    with held_domain(monkeypatch):
        count = run(
            (DOCS / f'{page}.md').read_text(encoding='utf-8'), tmp_path, NOT_RUN.get(page, ()))
    assert count == PAGES[page]
    drawn = {path.name for path in tmp_path.glob(f'{page}.png')}
    assert bool(drawn) == page.startswith('lesson')
    for name in drawn:
        assert compare_images(
            DOCS / 'figures' / name, tmp_path / name, tol=LARGEST_DIFFERENCE) is None


def test_an_output_that_is_not_printed_is_noticed(tmp_path: Path) -> None:
    page = '```python\nprint(6 * 7)\n```\n\n```text\n%s\n```\n'
    assert run(page % '4...', tmp_path) == 1
    with pytest.raises(AssertionError, match='^line 6: printed was\n42\n$'):
        run(page % '43', tmp_path)


@pytest.mark.parametrize('page, message', [
    ('```bash\necho a; false\n```\n', '^line 2: a\n$'),
    ('```ruby\n1\n```\n', '^line 2: a block of ruby cannot be run$'),
    ('text\n\n```text\n1\n```\n', '^line 4: an output without a block above it$')])
def test_what_fails_or_cannot_be_run_is_noticed(page: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match=message):
        run(page, tmp_path)


def test_what_a_block_leaves_behind_is_ended(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where it fails, or takes too long."""
    page = '```bash\nsleep 300 &\necho $! > child\n%s\n```\n'
    monkeypatch.setattr(blocks, 'TIMEOUT_S', 2.0)
    for end, message in (('true', ''), ('false', 'line 2: '), (
            'sleep 300', 'line 2: not finished after 2 s')):
        with pytest.raises(AssertionError, match=message) if message else nullcontext():
            run(page % end, tmp_path)
        child = int((tmp_path / 'child').read_text())
        wait_for(lambda pid=child: not is_alive(pid), 'the end of the child')


def test_files_are_written_and_python_stands_beside_them(tmp_path: Path) -> None:
    """And forgets them afterwards: another page may have a module of the same name."""
    page = ('```python\n# own_file.py\nvalue = %d\n```\n```yaml\nname: a_run\n```\n'
            '```c\n/* own.c */\nint a;\n```\n'
            '```python\nimport own_file\nprint(own_file.value, open("a_run.yaml").read())\n```\n'
            '```text\n%d name: a_run\n```\n')
    for value, folder in ((3, tmp_path / 'a'), (5, tmp_path / 'b')):
        folder.mkdir()
        assert run(page % (value, value), folder) == 4
        assert (folder / 'own.c').read_text() == '/* own.c */\nint a;\n'


def test_blocks_have_their_lines() -> None:
    first, second = blocks_of('a\n```bash\nls\n```\n\n```text\nb\n\nc\n```\n')
    assert first == ('bash', 'ls\n', 3) and second == ('text', 'b\n\nc\n', 7)
