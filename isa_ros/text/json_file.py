"""Results of commands as JSON files."""

import json
from pathlib import Path
from typing import Any


def write_tree(tree: Any, path: Path) -> None:
    """Write dictionaries and lists; raises ValueError for a number that is not finite."""
    path.write_text(json.dumps(tree, indent=2, allow_nan=False) + '\n', encoding='utf-8')


def write_wanted(tree: Any, path: Path | None) -> None:
    """Write as `write_tree` does and print the path; do nothing without a path."""
    if path is not None:
        write_tree(tree, path)
        print(path)
