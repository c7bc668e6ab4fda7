"""Columns of a CSV file, by name or number: commas, semicolons, tabs or spaces between numbers."""

from collections.abc import Sequence
from pathlib import Path

from isa_ros.core.suggest import alternatives
from isa_ros.errors import BagError, ConfigError
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_DELIMITERS = ('\t', ';', ',')


def read_columns(
        path: Path, wanted: Sequence[str | int], skip_lines: int, where: str
        ) -> dict[str | int, Floats]:
    """
    Return columns of a file, each (n,); the first line that is not skipped may have their names.

    ``where`` is the mapping's place for messages. With semicolons a number may have a decimal
    comma. Empty lines, and those that begin with #, are left out.

    Raises
    ------
    BagError
        The file cannot be read, has no rows, or an entry is not a number.
    ConfigError
        It has no such column.

    """
    try:
        text = path.read_text(encoding='utf-8-sig', errors='replace')
    except OSError as error:
        raise BagError(f'{path}: {error.strerror}') from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1)
             if number > skip_lines and line.strip() and not line.startswith('#')]
    if not lines:
        raise BagError(f'{path}: has no rows')
    delimiter = next((mark for mark in _DELIMITERS if mark in lines[0][1]), None)
    head = _cells(lines[0][1], delimiter)
    has_names = not all(map(_is_number, filter(None, head)))
    places = {name: _place(name, head if has_names else [], len(head), where) for name in wanted}
    rows = lines[1:] if has_names else lines
    if not rows:
        raise BagError(f'{path}: has no rows')
    found: dict[str | int, Floats] = {name: np.empty(len(rows)) for name in places}
    for k, (number, line) in enumerate(rows):
        cells = _cells(line, delimiter)
        for name, place in places.items():
            try:
                found[name][k] = float(cells[place])
            except (IndexError, ValueError):
                entry = repr(cells[place]) if place < len(cells) else 'missing'
                raise BagError(
                    f'{path}: line {number}, column {name}: {entry}, must be a number') from None
    return found


def _cells(line: str, delimiter: str | None) -> list[str]:
    cells = [cell.strip().strip('"') for cell in line.split(delimiter)]
    return [cell.replace(',', '.') for cell in cells] if delimiter == ';' else cells


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _place(name: str | int, names: Sequence[str], n_columns: int, where: str) -> int:
    """Return the index of a column."""
    if isinstance(name, int):
        if not 1 <= name <= n_columns:
            raise ConfigError(f'{where}: column {name}, must be 1 to {n_columns}')
        return name - 1
    if name not in names:
        raise ConfigError(f'{where}: column {name!r} is unknown; {alternatives(name, names)}')
    return list(names).index(name)
