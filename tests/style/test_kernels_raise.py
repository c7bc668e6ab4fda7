"""No kernel of the package raises an error: in an object it would end the process."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / 'isa_ros'
DECORATORS = {'kernel', 'part_of_kernel', 'called_kernel', 'kernel_function'}


def raising(source: str) -> list[str]:
    """Return the names of kernels of a source that raise or assert."""
    return [own.name for own in ast.walk(ast.parse(source))
            if isinstance(own, ast.FunctionDef)
            and any(isinstance(each, ast.Name) and each.id in DECORATORS
                    for each in own.decorator_list)
            and any(isinstance(node, ast.Raise | ast.Assert) for node in ast.walk(own))]


def test_none_raises_or_asserts() -> None:
    """Errors are for Python around kernels."""
    sources = {path: path.read_text(encoding='utf-8') for path in PACKAGE.rglob('*.py')}
    assert sum('@kernel' in source for source in sources.values()) > 100
    assert [(path.name, names) for path, source in sources.items()
            if (names := raising(source))] == []


def test_one_that_does_is_found() -> None:
    """In whatever part of it, and of none else."""
    assert raising('@kernel\ndef bad(x):\n    if x:\n        raise ValueError\n'
                   '@called_kernel\ndef worse(x):\n    assert x\n'
                   '@kernel\ndef good(x):\n    return x\n'
                   'def python(x):\n    raise ValueError\n') == ['bad', 'worse']
