"""
Tables of text: columns aligned for a terminal, or Markdown, and the numbers in them.

A table is a sequence of rows of cells; the header, if any, is the first. A string of ``l`` and
``r`` gives the alignment of each column, left or right; its last letter applies to all further
columns.
"""

from collections.abc import Sequence

from isa_ros.errors import printable

LEFT, RIGHT = 'l', 'r'
GAP = '  '      # between two columns

Cells = Sequence[str]

_RULES = {LEFT: '---', RIGHT: '---:'}


def aligned(rows: Sequence[Cells], sides: str = LEFT) -> list[str]:
    """
    Return a line for each row, every column as wide as its widest cell.

    Names of an untrusted bag may be in cells: what a terminal would act on is shown as its code.
    """
    rows = [[printable(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [padded(row, widths, sides) for row in rows]


def padded(cells: Cells, widths: Sequence[int], sides: str = LEFT) -> str:
    """Return one line of a table whose columns are at least ``widths`` wide."""
    return GAP.join(
        cell.rjust(width) if side == RIGHT else cell.ljust(width)
        for cell, width, side in zip(cells, widths, _sides(sides, len(cells)), strict=True)
    ).rstrip()


def markdown(rows: Sequence[Cells], sides: str = LEFT) -> list[str]:
    """Return the lines of a Markdown table; the first row is its header."""
    header, *body = rows
    head = ''.join(f'| {cell} ' if cell else '| ' for cell in header)
    rule = '|'.join(_RULES[side] for side in _sides(sides, len(header)))
    # A bar would end the cell.
    return [f'{head}|', f'|{rule}|', *(
        f'| {" | ".join(cell.replace("|", "/") for cell in row)} |' for row in body)]


def _sides(sides: str, n_columns: int) -> str:
    return sides.ljust(n_columns, sides[-1])[:n_columns]


def digits(value: float | None, n: int) -> str:
    """Return a number with ``n`` digits, without exponent if it is large; '-' for None."""
    if value is None:
        return '-'
    return f'{value:.0f}' if abs(value) >= 10.0 ** n else f'{value:.{n}g}'
