"""Child processes of the bench."""

import os
from pathlib import Path

from isa_ros.bench.child import environment, last_line, ROOT, run_module
import pytest


def test_an_environment_is_this_one_with_the_packages_first(monkeypatch, tmp_path):
    monkeypatch.setenv('PYTHONPATH', '/elsewhere')
    monkeypatch.setenv('ISA_KEPT', 'as it is')
    found = environment({'ISA_ADDED': 'too'}, tmp_path)
    assert found['PYTHONPATH'] == os.pathsep.join((str(tmp_path), '/elsewhere'))
    assert (found['ISA_KEPT'], found['ISA_ADDED']) == ('as it is', 'too')
    assert environment()['PYTHONPATH'].startswith(f'{ROOT}{os.pathsep}')


def test_its_python_keeps_bytecode_whatever_this_one_does(monkeypatch, tmp_path):
    """A start is measured as that of an installation, which has it."""
    (tmp_path / 'measured.py').write_text('import beside\n', encoding='utf-8')
    (tmp_path / 'beside.py').write_text('', encoding='utf-8')
    monkeypatch.setenv('PYTHONDONTWRITEBYTECODE', '1')
    monkeypatch.delenv('PYTHONPYCACHEPREFIX', raising=False)
    ended = run_module('measured', [], 60.0, tmp_path)
    assert ended.returncode == 0, last_line(ended)
    kept = {path.name.partition('.')[0] for path in Path(tmp_path, '__pycache__').iterdir()}
    assert 'beside' in kept


@pytest.mark.parametrize(('stderr', 'expected'), [
    ('one\ntwo\n', 'two'), (' \n', 'exit code 3')])
def test_the_last_line_of_a_failure_says_why(stderr, expected, tmp_path):
    (tmp_path / 'failing.py').write_text(
        f'import sys\nsys.stderr.write({stderr!r})\nsys.exit(3)\n', encoding='utf-8')
    assert last_line(run_module('failing', [], 60.0, tmp_path)) == expected
