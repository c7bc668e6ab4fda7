"""
Strict YAML for hand-written files: duplicate keys, aliases, tags and large files are refused.

Scalars follow the JSON schema of YAML 1.2, so that `1e5` is a number and `on` is a name.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
import re
from typing import Any, NoReturn

from isa_ros.errors import ConfigError
import yaml

Scalar = str | int | float | bool | None
Tree = dict[str, 'Scalar | Tree | list[Any]']

MAX_BYTES = 1 << 20   # of one file; the largest shipped one has 8 kB
MAX_NODES = 20_000    # of one file
MAX_DEPTH = 16        # of nested sections
MAX_DIGITS = 300      # of a whole number: a double holds 308
_SHORT = re.compile('[ -~]{0,40}')
_TAB = 'begins with a tab, must be indented by spaces'


_SCALARS = (
    ('tag:yaml.org,2002:null', re.compile(r'^(?:~|null|)$'), ['~', 'n', '']),
    ('tag:yaml.org,2002:bool', re.compile(r'^(?:true|false)$'), list('tf')),
    ('tag:yaml.org,2002:int', re.compile(r'^[-+]?(?:0|[1-9][0-9]*)$'), list('-+0123456789')),
    ('tag:yaml.org,2002:float', re.compile(
        r'^(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan)$'),
        list('-+.0123456789')),
)


class _Strict(yaml.composer.Composer):
    """Scalars of YAML 1.2, no aliases, bounded size; a second base class is the parser."""

    check_event: Callable[..., bool]
    peek_event: Callable[[], Any]
    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}
    nodes = 0
    depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            self._refuse('aliases (*name) are not read')
        if getattr(self.peek_event(), 'tag', None) is not None:
            self._refuse('tags (!name) are not read')
        self.nodes += 1
        if self.nodes > MAX_NODES:
            self._refuse(f'more than {MAX_NODES} values')
        self.depth += 1
        if self.depth > MAX_DEPTH:
            self._refuse(f'nested deeper than {MAX_DEPTH} sections')
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def _refuse(self, problem: str) -> NoReturn:
        raise yaml.composer.ComposerError(None, None, problem, self.peek_event().start_mark)


class _PythonLoader(_Strict, yaml.reader.Reader, yaml.scanner.Scanner, yaml.parser.Parser,
                    yaml.constructor.SafeConstructor, yaml.resolver.Resolver):

    def __init__(self, text: str) -> None:
        yaml.reader.Reader.__init__(self, text)
        yaml.scanner.Scanner.__init__(self)
        yaml.parser.Parser.__init__(self)
        _Strict.__init__(self)
        yaml.constructor.SafeConstructor.__init__(self)
        yaml.resolver.Resolver.__init__(self)


_Loader: Any = _PythonLoader
if yaml.__with_libyaml__:
    class _LibraryLoader(_Strict, yaml.CSafeLoader):
        """Twenty times as fast; saves half a second when a process of a run starts."""

        def __init__(self, text: str) -> None:
            yaml.CSafeLoader.__init__(self, text)
            _Strict.__init__(self)

    _Loader = _LibraryLoader


class _PythonDumper(yaml.SafeDumper):
    """Quotes every text that YAML 1.1 or 1.2 would read as another type."""


_Dumper: Any = _PythonDumper
if yaml.__with_libyaml__:
    class _LibraryDumper(yaml.CSafeDumper):
        """Five times as fast: the same bytes for plain texts; others it may cut elsewhere."""

    _Dumper = _LibraryDumper


for _class in {_PythonLoader, _Loader, _PythonDumper, _Dumper}:
    for _scalar in _SCALARS:
        _class.add_implicit_resolver(*_scalar)


def _plain(node: yaml.Node, loader: Any, name: str) -> Any:
    """Return a composed node as dictionaries, lists and scalars."""
    if isinstance(node, yaml.SequenceNode):
        return [_plain(child, loader, name) for child in node.value]
    if isinstance(node, yaml.MappingNode):
        tree: Tree = {}
        for key_node, value_node in node.value:
            key = _plain(key_node, loader, name)
            if not isinstance(key, str):
                raise _error(key_node, name, f'key {key!r} must be a name')
            if key in tree:
                raise _error(key_node, name, f'duplicate key {key}')
            tree[key] = _plain(value_node, loader, name)
        return tree
    if node.tag.endswith(':int') and len(node.value) > MAX_DIGITS:
        raise _error(node, name, f'a number of {len(node.value)} digits, must be <= {MAX_DIGITS}')
    try:
        return loader.construct_object(node)
    except (yaml.YAMLError, ValueError) as error:
        raise _error(node, name, f'cannot read {node.value!r}') from error


def _error(node: yaml.Node, name: str, what: str) -> ConfigError:
    return ConfigError(f'{name}: line {node.start_mark.line + 1}: {what}')


def parse(text: str, name: str) -> Tree:
    """
    Return the top-level section of a YAML text; ``name`` is its file's name, for messages.

    Raises
    ------
    ConfigError
        The text is not YAML, not one section or too large, or has an alias, a tag or a
        duplicate key; the message has the line.

    """
    if len(text.encode('utf-8', 'replace')) > MAX_BYTES:
        raise ConfigError(f'{name}: larger than {MAX_BYTES} bytes, must be smaller')
    try:
        loader = _Loader(text)
        node = loader.get_single_node()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        problem = _TAB if _is_at_tab(text, line) else error.problem or error.context
        raise ConfigError(f'{name}: line {line}: {problem}') from error
    except yaml.YAMLError as error:
        raise ConfigError(f'{name}: is not YAML: {str(error).splitlines()[0]}') from error
    if not isinstance(node, yaml.MappingNode):
        raise ConfigError(f'{name}: must be sections of `key: value`')
    tree: Tree = _plain(node, loader, name)
    return tree


def _is_at_tab(text: str, line: int) -> bool:
    """Return whether the indentation of a line, from 1 on, has a tab."""
    lines = text.splitlines()[line - 1:line]
    return any('\t' in own[:len(own) - len(own.lstrip())] for own in lines)


def read(path: Path) -> Tree:
    """
    Return the top-level section of a file.

    Raises
    ------
    ConfigError
        The file cannot be read, or `parse` refuses its text.

    """
    try:
        with path.open('rb') as file:
            raw = file.read(MAX_BYTES + 1)
        return parse(raw.decode('utf-8'), path.name)
    except OSError as error:
        raise ConfigError(f'{path}: cannot be read: {error.strerror}') from error
    except UnicodeDecodeError as error:
        raise ConfigError(f'{path.name}: byte {error.start}: is not UTF-8') from error


def dump(tree: Mapping[str, Any]) -> str:
    """Return the YAML text of a tree in its own order; floats keep every bit."""
    text: str = yaml.dump(
        dict(tree), Dumper=_Dumper if _is_plain(tree) else _PythonDumper, sort_keys=False,
        default_flow_style=None, width=99, allow_unicode=True)
    return text


def _is_plain(value: Any) -> bool:
    """
    Return whether both dumpers write a tree alike.

    Its texts are short and of ASCII, its keys such texts and not empty, all else is numbers.
    """
    if isinstance(value, Mapping):
        return all(isinstance(key, str) and key and _is_plain(key) and _is_plain(below)
                   for key, below in value.items())
    if isinstance(value, list | tuple):
        return all(map(_is_plain, value))
    if isinstance(value, str):
        return _SHORT.fullmatch(value) is not None
    return value is None or isinstance(value, bool | int | float)
