"""
Message definitions in the form of rosbag2, from the installed message packages.

The text is the root's .msg file, then every type it uses, depth first, sorted, each once,
after a line of 80 ``=`` and a line ``MSG: package/Type``; the hash is RIHS01 of REP-2011.
"""

from importlib.util import find_spec
import json
import os
from pathlib import Path
import re
from typing import NamedTuple

from isa_ros.errors import IsaError

SEPARATOR = '=' * 80
ENCODING = 'ros2msg'

_FIELD_TYPE = re.compile(r'(?:^|\n)\s*([a-zA-Z0-9_/]+)(?:\[[^\]]*\])?\s+')
_BUILT_IN = frozenset((
    'bool', 'byte', 'char', 'float32', 'float64', 'int8', 'uint8', 'int16', 'uint16',
    'int32', 'uint32', 'int64', 'uint64', 'string'))


class DefinitionError(IsaError):
    """The definition of a message type is not installed."""


class Definition(NamedTuple):
    """Schema text and type hash of one message type."""

    text: str
    type_hash: str


def definition(type_name: str) -> Definition:
    """
    Return the definition of a type such as ``sensor_msgs/msg/JointState``.

    Raises
    ------
    DefinitionError
        its package, or one it depends on, is not installed.

    """
    text = _with_dependencies(type_name, set())
    described = json.loads(_share_file(type_name, 'json').read_text(encoding='utf-8'))
    for entry in described['type_hashes']:
        if entry['type_name'] == type_name:
            return Definition(text, entry['hash_string'])
    raise DefinitionError(f'{_share_file(type_name, "json")}: no type hash of {type_name}')


def _with_dependencies(type_name: str, seen: set[str]) -> str:
    text = _share_file(type_name, 'msg').read_bytes().decode()
    result = text
    for dependency in _dependencies(text, type_name.split('/')[0]):
        if dependency not in seen:
            seen.add(dependency)
            result += f'\n{SEPARATOR}\nMSG: {dependency}\n'
            result += _with_dependencies(dependency, seen)
    return result


def _dependencies(text: str, package: str) -> list[str]:
    found = set(_FIELD_TYPE.findall(text)) - _BUILT_IN
    return sorted(name if '/' in name else f'{package}/{name}' for name in found)


def _share_file(type_name: str, suffix: str) -> Path:
    """Return share/PACKAGE/msg/NAME.SUFFIX of the first prefix that has it."""
    package, *_, name = type_name.split('/')
    relative = Path('share') / package / 'msg' / f'{name}.{suffix}'
    for prefix in _prefixes(package):
        if (prefix / relative).is_file():
            return prefix / relative
    raise DefinitionError(
        f'{type_name}: no {relative} under AMENT_PREFIX_PATH or the prefix that {package} '
        'is installed in')


def _prefixes(package: str) -> list[Path]:
    """Return the prefixes to search: sourced ones first, then those of the Python package."""
    sourced = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    spec = find_spec(package)
    installed = [] if spec is None or spec.origin is None else Path(spec.origin).parents
    return [*(Path(prefix) for prefix in sourced if prefix), *installed]
