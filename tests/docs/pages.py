"""The examples of the pages in docs/, and a run file made of them."""

from pathlib import Path
import re

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run

ROOT = Path(__file__).parents[2]
DOCS = ROOT / 'docs'


def text_of(name: str) -> str:
    """Return the text of a page."""
    return (DOCS / f'{name}.md').read_text(encoding='utf-8')


def example(name: str, start: str) -> str:
    """Return the YAML block of a page that begins with a text."""
    found = re.findall(r'```yaml\n(.*?)```', text_of(name), re.DOTALL)
    return next(block for block in found if block.startswith(start))


def head() -> str:
    """Return the first keys of the run file of docs/runs.md, before its actuators."""
    own = example('runs', 'name: my_ram')
    return own[:own.index('actuators:')]


def actuators() -> str:
    """Return the rest of that run file."""
    return example('runs', 'name: my_ram')[len(head()):]


def run_of(text: str, folder: Path) -> RunConfig:
    """Return a run file with that head, and other actuators in it."""
    path = folder / 'my_run.yaml'
    path.write_text(head() + text)
    return load_run(path)
