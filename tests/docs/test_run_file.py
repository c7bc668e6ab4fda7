"""docs/run_file.md says what the rows of the keys declare."""

from pathlib import Path
import re

from isa_ros.config.runs.actuator_config import ACTUATOR
from isa_ros.config.runs.run_config import RUN
from isa_ros.config.runs.run_file import load_run
from scripts import write_run_file

PAGE = write_run_file.PAGE.read_text(encoding='utf-8')


def test_its_tables_are_those_of_the_rows() -> None:
    """`python scripts/write_run_file.py` after a change of a key."""
    assert write_run_file.page(PAGE) == PAGE


def test_a_changed_default_is_noticed() -> None:
    changed = PAGE.replace('| 0.12 |', '| 0.13 |', 1)
    assert changed != PAGE and write_run_file.page(changed) == PAGE


def test_every_key_is_there() -> None:
    for table in (RUN, ACTUATOR):
        assert all(f'\n| `{key.name}` | ' in PAGE for key in table.keys)


def test_its_example_can_be_run(tmp_path: Path) -> None:
    [example] = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)
    path = tmp_path / 'shortest.yaml'
    path.write_text(example)
    run = load_run(path)
    assert (run.step_ns, run.controller_offset_ns, run.tick_timeout_s) == (1_000_000, 120_000, 5.0)
