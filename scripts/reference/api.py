"""The public names of `isa_ros`: signatures, fields and docstrings, from their source."""

import ast
from collections.abc import Iterator
import inspect
import textwrap
from typing import Any

import isa_ros
from scripts.reference.markup import code, docstring, page, table

_HEAD = """\
`import isa_ros` has these names; each is loaded where it is used first. Bodies of one's own are
on [their page](../bodies.md), columns of results and fields of samples on
[signals](../signals.md). MuJoCo as a body is `isa_ros.mujoco`, tests of your own
`isa_ros.testing`, nodes `isa_ros.nodes`."""


def api_page() -> str:
    """Return the page, a section for each name."""
    return page('API of Python', _HEAD, *(
        part for name in sorted(isa_ros.__all__, key=str.lower)
        for part in section(name, getattr(isa_ros, name))))


def section(name: str, own: Any) -> Iterator[str]:
    """Yield the paragraphs of a public class or function."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(own))).body[0]
    yield f'## {name}'
    if isinstance(tree, ast.FunctionDef):
        yield _signature(name, tree)
        yield _text(tree)
        return
    assert isinstance(tree, ast.ClassDef)
    members = [part for part in tree.body if isinstance(part, ast.FunctionDef)]
    yield from (_signature(name, member) for member in members if member.name == '__init__')
    yield _text(tree)
    yield _fields(tree)
    for member in members:
        if not member.name.startswith('_'):
            yield f'### {name}.{member.name}'
            if not _is_property(member):
                yield _signature(f'{name}.{member.name}', member)
            yield _text(member)


def _text(tree: ast.FunctionDef | ast.ClassDef) -> str:
    return docstring(ast.get_docstring(tree) or '')


def _is_property(tree: ast.FunctionDef) -> bool:
    return any('property' in ast.unparse(own) for own in tree.decorator_list)


def _signature(name: str, tree: ast.FunctionDef) -> str:
    """Return how a function is called, without self or cls."""
    given = tree.args
    given.args = [own for own in given.args if own.arg not in ('self', 'cls')]
    returned = '' if tree.returns is None else f' -> {ast.unparse(tree.returns)}'
    whole = f'{name}({ast.unparse(given)}){returned}'.replace("'", '')
    return f'```python\n{whole}\n```'


def _fields(tree: ast.ClassDef) -> str:
    """Return the public fields of a record with their docstrings; '' where there are none."""
    rows = []
    for field, after in zip(tree.body, [*tree.body[1:], None]):
        if not isinstance(field, ast.AnnAssign) or ast.unparse(field.target).startswith('_'):
            continue
        meaning = ''
        if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            meaning = ' '.join(docstring(str(after.value.value)).split())
        default = '' if field.value is None else ast.unparse(field.value)
        rows.append([code(ast.unparse(field.target)),
                     code(ast.unparse(field.annotation).replace(' | ', ' or ')),
                     code(default), meaning.replace('|', 'or')])
    return table(['field', 'type', 'default', 'meaning'], rows) if rows else ''
