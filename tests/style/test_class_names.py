"""The name of a class stands for one thing: no two modules define it."""

import ast
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ('isa_ros', 'msg_adapters', 'benchmarks', 'scripts')
SEVERAL: Mapping[str, str] = {}
"""Names that several modules may define, each with the reason."""


def repeated(root: Path, folders: Sequence[str] = FOLDERS) -> dict[str, list[str]]:
    """Return the modules of each class, at any depth, that several modules define."""
    found: dict[str, list[str]] = {}
    for path in sorted(path for folder in folders for path in (root / folder).rglob('*.py')):
        for name in {node.name for node in ast.walk(ast.parse(path.read_text(encoding='utf-8')))
                     if isinstance(node, ast.ClassDef)}:
            found.setdefault(name, []).append(str(path.relative_to(root)))
    return {name: modules for name, modules in found.items() if len(modules) > 1}


@pytest.mark.linter
def test_the_name_of_a_class_stands_for_one_thing() -> None:
    found = repeated(ROOT)
    assert found.keys() == SEVERAL.keys(), found


def test_a_name_that_two_modules_define_is_found(tmp_path: Path) -> None:
    for name, text in {
            'one/valve.py': 'class Spool: ...\nclass Land: ...\nclass _Slot: ...',
            'one/below/coil.py': 'def made():\n    class Spool: ...\n    return Spool',
            'two/loop.py': 'class Loop:\n    class _Slot: ...\nText = """\nclass Land: ..."""',
            'two/page.txt': 'class Loop: ...',
            'three/other.py': 'class Loop: ...'}.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert repeated(tmp_path, ('one', 'two')) == {
        'Spool': ['one/below/coil.py', 'one/valve.py'], '_Slot': ['one/valve.py', 'two/loop.py']}
    assert repeated(tmp_path, ('one', 'two', 'three')).keys() == {'Spool', '_Slot', 'Loop'}
