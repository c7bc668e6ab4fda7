"""
The blocks of a page of docs/: fenced ones, and indented lines that begin with a command.

A block of any kind whose first line is a comment with the name of a file is that file, and a
``yaml`` block that begins with a name is NAME.yaml.
"""

import re
import textwrap
from typing import NamedTuple

_BLOCK = re.compile(r'^```(\w+)\n(.*?)^```$', re.MULTILINE | re.DOTALL)
_FILE = re.compile(r'(?:# |/\* |<!-- )(\w+\.\w+)(?: \*/| -->)?\n')
_INDENTED = re.compile(r'(?<=\n\n)((?: {4,}.*\n)+)')
_COMMANDS = (
    'isa', 'python', 'ros2', 'pip', 'sudo', 'source', 'export', 'git', 'unshare', 'nsenter',
    'modprobe', 'ss', 'sed', 'tshark', 'smart_manifold', '.venv/bin/python')
_NAME = re.compile(r'name: (\w+)\n')


class Block(NamedTuple):
    """A fenced block of a page."""

    kind: str
    text: str
    line: int
    """Of its first line in the page."""


def blocks_of(page: str) -> list[Block]:
    """Return the fenced blocks of a page and its indented commands, in order."""
    fenced = [Block(found[1], found[2], page[:found.start(2)].count('\n') + 1)
              for found in _BLOCK.finditer(page)]
    between = _BLOCK.sub(lambda found: '\n' * found[0].count('\n'), page)
    indented = [
        Block('command', textwrap.dedent(found[1]), between[:found.start()].count('\n') + 1)
        for found in _INDENTED.finditer(between) if _is_command(found[1].strip())]
    return sorted([*fenced, *indented], key=lambda block: block.line)


def _is_command(text: str) -> bool:
    first = text.removeprefix('$ ').removeprefix('./').split()[0]
    return first in _COMMANDS


def first_line(block: Block) -> str:
    """Return the line by which a block is named, without its comment."""
    return re.split(r'\s+#', block.text.partition('\n')[0])[0].strip()


def is_part(block: Block) -> bool:
    """Claim that a block is a part of a file, which cannot be used alone."""
    return block.kind in ('yaml', 'xml', 'cmake') and not own_file(block)


def own_file(block: Block) -> str | None:
    """Return the name of the file that a block is."""
    if own := _FILE.match(block.text):
        return own[1]
    own = _NAME.match(block.text) if block.kind == 'yaml' else None
    return f'{own[1]}.yaml' if own else None
