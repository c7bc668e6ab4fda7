"""Columns of a CSV file, by name or number: commas, semicolons, tabs or spaces between numbers."""

from collections.abc import Mapping, Sequence
import csv
from pathlib import Path
import re

from isa_ros.core.suggest import alternatives, shortened
from isa_ros.errors import BagError, ConfigError
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_DELIMITERS = ('\t', ';', ',')
_QUOTED = re.compile('"[^"]*"')
_UTF_16 = (b'\xff\xfe', b'\xfe\xff')


def read_columns(
        path: Path, wanted: Sequence[str | int], skip_lines: int, where: str
        ) -> dict[str | int, Floats]:
    """
    Return columns of a file, each (n,); the first line that is not skipped may have their names.

    ``where`` is the mapping's place for messages. A cell in double quotes may have delimiters.
    With semicolons a number may have a decimal comma. Empty lines, and those that begin with #,
    are left out. Behind its last number a row may have remarks, also beyond the names, or lack
    them.

    Raises
    ------
    BagError
        The file cannot be read, has no rows, an entry is not a number, or a row has numbers beyond
        the names or fewer cells than the others have numbers.
    ConfigError
        It has no such column, or two of that name.

    """
    lines = [(f'{path}: line {number}', line)
             for number, line in enumerate(_text(path).splitlines(), start=1)
             if number > skip_lines and line.strip() and not line.startswith('#')]
    if not lines:
        raise BagError(f'{path}: has no rows')
    bare = _QUOTED.sub('', lines[0][1])
    delimiter = next((mark for mark in _DELIMITERS if mark in bare), ' ')
    head = _cells(*lines[0], delimiter)
    has_names = any(cell and _number(cell, delimiter) is None for cell in head)
    places = {name: _place(name, head if has_names else [], len(head), where) for name in wanted}
    rows = lines[1:] if has_names else lines
    if not rows:
        raise BagError(f'{path}: has no rows')
    return _numbers(rows, places, len(head), delimiter)


def _numbers(
        rows: Sequence[tuple[str, str]], places: Mapping[str | int, int], n_head: int,
        delimiter: str) -> dict[str | int, Floats]:
    """Return the columns at some places of rows, which are the place and text of each line."""
    found: dict[str | int, Floats] = {name: np.empty(len(rows)) for name in places}
    lengths, widths = np.zeros(len(rows), np.int64), np.zeros(len(rows), np.int64)
    for k, (where, line) in enumerate(rows):
        cells = _cells(where, line, delimiter)
        lengths[k], widths[k] = len(cells), _width(cells, delimiter)
        if widths[k] > n_head or len(cells) <= max(places.values(), default=0):
            raise _uneven(where, len(cells), n_head)
        for name, place in places.items():
            value = _number(cells[place], delimiter)
            if value is None:
                raise BagError(
                    f'{where}, column {name}: {shortened(repr(cells[place]))}, must be a number')
            found[name][k] = value
    short = np.flatnonzero(lengths < widths.max())
    if len(short):
        raise _uneven(rows[short[0]][0], lengths[short[0]], n_head)
    return found


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BagError(f'{path}: {error.strerror}') from None
    if data.startswith(_UTF_16) or b'\0' in data[:2]:
        raise BagError(f'{path}: its encoding is UTF-16 or UTF-32, must be UTF-8')
    return data.decode('utf-8-sig', errors='replace')


def _uneven(where: str, n: int, n_head: int) -> BagError:
    return BagError(f'{where}: {n} cells, the head has {n_head}')


def _cells(where: str, line: str, delimiter: str) -> list[str]:
    """Return the cells of a line; many spaces, or tabs among spaces, are one delimiter."""
    row = line.strip(' ') if delimiter != ' ' else line.expandtabs(1).strip()
    if '"' not in row and delimiter != ' ':
        return [cell.strip() for cell in row.split(delimiter)]
    try:
        cells = next(csv.reader([row], delimiter=delimiter, skipinitialspace=True))
    except csv.Error as error:
        raise BagError(f'{where}: {error}') from None
    return [cell.strip() for cell in cells]


def _number(cell: str, delimiter: str) -> float | None:
    """Return the number of a cell, None for anything else."""
    if '_' in cell or not cell.isascii():     # Python's own floats may have both
        return None
    try:
        return float(cell.replace(',', '.') if delimiter == ';' else cell)
    except ValueError:
        return None


def _width(cells: Sequence[str], delimiter: str) -> int:
    """Return the number of cells up to the last one that is a number."""
    width = len(cells)
    while width and _number(cells[width - 1], delimiter) is None:
        width -= 1
    return width


def _place(name: str | int, names: Sequence[str], n_columns: int, where: str) -> int:
    """Return the index of a column."""
    if isinstance(name, int):
        if not 1 <= name <= n_columns:
            raise ConfigError(f'{where}: column {name}, must be 1 to {n_columns}')
        return name - 1
    places = [k for k, own in enumerate(names) if own == name]
    if not places:
        raise ConfigError(f'{where}: column {name!r} is unknown; {alternatives(name, names)}')
    if len(places) > 1:
        raise ConfigError(f'{where}: column {name!r} is named twice, columns {places[0] + 1} and '
                          f'{places[1] + 1}; give its number')
    return places[0]
