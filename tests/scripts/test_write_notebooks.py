"""Lessons become notebooks, and run as such with what the pages print."""

from doctest import ELLIPSIS, NORMALIZE_WHITESPACE, OutputChecker
from importlib.util import find_spec
import json
from pathlib import Path
import re
from typing import Any

import nbformat
import pytest
from scripts import write_notebooks
from scripts.write_notebooks import DOCS, LESSONS, main, notebook, ROOT

PAGE = """# A lesson

Text with [a page](loops.md#gains), [a site](https://a.org) and [a place](#here).

```python
value = 6
print(value)
```

```text
6
```

![Two lines
of a figure](figures/lesson.png)

More text:

```bash
./isa step isa_v5 \\
    --loop force
cat ./isa | head -1
```
"""
_PROGRESS = re.compile('^.*\x1b\\[K', re.DOTALL)
_OUTPUT = re.compile(r'^```text\n(.*?)^```$', re.MULTILINE | re.DOTALL)


def test_a_page_becomes_text_and_cells() -> None:
    """Without outputs and figures, which it makes itself; links from where it lies."""
    cells = notebook(PAGE, '../docs')['cells']
    assert [(cell['cell_type'], cell['source']) for cell in cells] == [
        ('markdown', '# A lesson\n\nText with [a page](../docs/loops.md#gains), '
                     '[a site](https://a.org) and [a place](#here).'),
        ('code', 'value = 6\nprint(value)'), ('markdown', 'More text:'),
        ('code', 'import sys\n!{sys.executable} -m isa_ros step isa_v5 \\\n    --loop force\n'
                 'cat ./isa | head -1')]
    assert [cell['id'] for cell in cells] == ['cell-0', 'cell-1', 'cell-2', 'cell-3']


def test_every_lesson_is_written_without_outputs(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert set(LESSONS) == {path.stem for path in DOCS.glob('lesson_*.md')}
    out = tmp_path / 'a' / 'b'
    assert main([str(out)]) == 0
    paths = [Path(line) for line in capsys.readouterr().out.splitlines()]
    assert paths == [out / f'{name}.ipynb' for name in LESSONS]
    for path in paths:
        made = nbformat.read(path, as_version=4)
        nbformat.validate(made)
        code = [cell for cell in made.cells if cell.cell_type == 'code']
        assert len(code) > 4 and all(cell.outputs == [] for cell in code)
        texts = ' '.join(cell.source for cell in made.cells if cell.cell_type == 'markdown')
        links = re.findall(r'\]\((?!https?:|#)([^)#\s]+)', texts)
        assert links and all((out / link).is_file() for link in links)


def test_they_are_in_the_build_directory_if_none_is_named(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(write_notebooks, 'ROOT', tmp_path)
    assert main([]) == 0
    written = json.loads((tmp_path / 'build' / 'notebooks' / 'lesson_valve.ipynb').read_text())
    assert written['nbformat'] == 4 and written['nbformat_minor'] == 5


@pytest.mark.slow
@pytest.mark.skipif(
    not (find_spec('nbclient') and find_spec('ipykernel')),
    reason='nbclient or ipykernel not installed: requirements-docs.txt')
@pytest.mark.parametrize('name', LESSONS)
def test_a_lesson_runs_in_a_kernel_with_the_outputs_of_its_page(
        name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from nbclient import NotebookClient
    monkeypatch.setenv('PYTHONPATH', str(ROOT), prepend=':')
    for folder in ('JUPYTER_RUNTIME_DIR', 'JUPYTER_CONFIG_DIR', 'IPYTHONDIR'):
        monkeypatch.setenv(folder, str(tmp_path / folder))
    made = nbformat.read(write_notebooks.write(name, tmp_path), as_version=4)
    NotebookClient(made, timeout=300, resources={'metadata': {'path': str(tmp_path)}}).execute()
    cells = [cell for cell in made.cells if cell.cell_type == 'code']
    printed = [text for cell in cells if (text := _printed(cell.outputs))]
    shown = _OUTPUT.findall((DOCS / f'{name}.md').read_text(encoding='utf-8'))
    assert len(printed) == len(shown) > 2
    for expected, got in zip(shown, printed):
        assert OutputChecker().check_output(expected, got, ELLIPSIS | NORMALIZE_WHITESPACE), got
    assert sum('image/png' in output.get('data', {})
               for cell in cells for output in cell.outputs) == 1


def _printed(outputs: list[Any]) -> str:
    """Return what a cell prints, without the progress that a terminal overwrites."""
    text = ''.join(output.text for output in outputs if output.output_type == 'stream')
    return _PROGRESS.sub('', text)
