"""Files of tests are short enough to be read at once."""

from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
MOST = 300      # lines


def too_long(folder: Path, most: int) -> dict[str, int]:
    """Return the lines of each Python file below a folder that has more than ``most``."""
    lengths = {str(path.relative_to(folder)): len(path.read_text(encoding='utf-8').splitlines())
               for path in folder.rglob('*.py')}
    return {name: n for name, n in lengths.items() if n > most}


@pytest.mark.linter
def test_no_file_of_tests_is_longer_than_300_lines() -> None:
    assert too_long(TESTS, MOST) == {}


def test_a_file_of_one_line_more_is_found(tmp_path: Path) -> None:
    (tmp_path / 'one').mkdir()
    for name, n in (('one/long.py', 8), ('one/short.py', 7), ('long.txt', 9)):
        (tmp_path / name).write_text('x\n' * n)
    assert too_long(tmp_path, 7) == {'one/long.py': 8}
