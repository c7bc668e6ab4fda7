"""Results as JSON files."""

import json
from pathlib import Path
from typing import Any


def write_tree(tree: Any, path: Path) -> None:
    """Write dictionaries and lists; raises ValueError for a number that is not finite."""
    path.write_text(json.dumps(tree, indent=2, allow_nan=False) + '\n', encoding='utf-8')
