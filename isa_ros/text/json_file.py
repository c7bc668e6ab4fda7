"""Results of commands as JSON files."""

import json
from pathlib import Path
from typing import Any

from isa_ros.core.atomic_file import replace_file


def write_tree(tree: Any, path: Path) -> None:
    """
    Write dictionaries and lists, whole or not at all: after an error the file is as before.

    Raises
    ------
    ValueError
        A number is not finite.
    OSError
        The file cannot be written.

    """
    text = json.dumps(tree, indent=2, allow_nan=False) + '\n'
    replace_file(path, text.encode(), is_durable=False)


def write_wanted(tree: Any, path: Path | None) -> None:
    """Write as `write_tree` does and print the path; do nothing without a path."""
    if path is not None:
        write_tree(tree, path)
        print(path)
