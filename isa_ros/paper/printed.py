"""
Strict access to the paper's numbers: tables by row and column, statements by name.

A number keeps its printed text, with its relation (`<`, `>`) and its note. Nothing is corrected
here; docs/paper-errata.md explains how the paper is read.
"""

from functools import cache
from pathlib import Path
import re
from typing import Any, NamedTuple

from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError

_PACKAGE = Path(__file__).parent
_NUMBER = re.compile(
    r'(?P<relation>[<>])?(?P<digits>-?(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?(?:e-?\d+)?)'
    r'(?P<note>\*| \([^()]+\))?')
TEXT = 'text'    # the unit of a value in words
NO_NUMBERS = ('-', 'built-in')  # texts that are allowed in place of a number


@frozen
class Printed:
    """One printed value."""

    where: str
    """Table, equation, figure or section."""
    what: str
    text: str
    value: float | None
    """None if the paper prints words or nothing."""
    unit: str

    @property
    def is_bound(self) -> bool:
        """Return whether the printed value is a bound, with < or >."""
        return self.text.startswith(('<', '>'))

    @property
    def number(self) -> float:
        """
        Return the value as a number.

        Raises
        ------
        ConfigError
            The paper prints no number here.

        """
        if self.value is None:
            raise ConfigError(f'{self.where}: {self.what} = {self.text!r} is not a number')
        return self.value

    @property
    def half_digit(self) -> float:
        """Return half of the last digit the number is printed with; raises as `number`."""
        _ = self.number     # refuses words
        match = _NUMBER.fullmatch(self.text)
        assert match is not None, 'a value was read from this text'
        mantissa, _, exponent = match['digits'].partition('e')
        decimals = len(mantissa.partition('.')[2])
        return 0.5 * 10.0 ** (int(exponent or 0) - decimals)


class Table(NamedTuple):
    """One table of the paper."""

    name: str
    caption: str
    columns: tuple[str, ...]
    rows: dict[str, tuple[Printed, ...]]


@cache
def tables() -> dict[str, Table]:
    """Return tables 1 to 5 by name: table_1, ..."""
    return read_tables(read(_PACKAGE / 'tables.yaml'), Place('tables.yaml'))


@cache
def statements() -> dict[str, Printed]:
    """Return the values from text, equations and captions, by name."""
    return read_statements(read(_PACKAGE / 'statements.yaml'), Place('statements.yaml'))


def cell(table: str, row: str, column: str) -> Printed:
    """
    Return one cell of a table.

    Raises
    ------
    ConfigError
        The table, row or column does not exist; the message has the nearest names.

    """
    found = tables().get(table)
    if found is None:
        raise ConfigError(f'{table} is not a table; {alternatives(table, tables())}')
    for name, names in ((row, found.rows), (column, found.columns)):
        if name not in names:
            raise ConfigError(f'{table} has no {name!r}; {alternatives(name, names)}')
    return found.rows[row][found.columns.index(column)]


def statement(name: str) -> Printed:
    """Return one statement; as `cell`."""
    if name not in statements():
        raise ConfigError(f'{name} is not a statement; {alternatives(name, statements())}')
    return statements()[name]


def read_tables(tree: Tree, place: Place) -> dict[str, Table]:
    """
    Return the tables of a file.

    Raises
    ------
    ConfigError
        A key, a row or a cell is invalid.

    """
    return {name: _table(name, section_at(below, place / name), place / name)
            for name, below in tree.items()}


def read_statements(tree: Tree, place: Place) -> dict[str, Printed]:
    """Return the statements of a file; as `read_tables`."""
    found = {}
    for name, below in tree.items():
        here = place / name
        section = section_at(below, here)
        _exactly(section, ('where', 'says', 'printed', 'unit'), here)
        where, says, printed, unit = (
            _text(section[key], here / key) for key in ('where', 'says', 'printed', 'unit'))
        found[name] = Printed(
            where, says, printed, _value(printed, unit, here / 'printed'), unit)
    return found


def _table(name: str, tree: Tree, place: Place) -> Table:
    _exactly(tree, ('caption', 'columns', 'rows'), place)
    columns = tuple(_texts(tree['columns'], place / 'columns'))
    rows: dict[str, tuple[Printed, ...]] = {}
    given = tree['rows']
    if not isinstance(given, list) or not given:
        raise ConfigError(f'{place}.rows = {given!r}, must be a list of rows')
    for k, below in enumerate(given):
        here = Place(place.file, f'{place.key}.rows[{k}]')
        title, cells = _row(name, columns, section_at(below, here), here)
        if title in rows:
            raise ConfigError(f'{here}.row = {title!r} occurs twice')
        rows[title] = cells
    return Table(name, _text(tree['caption'], place / 'caption'), columns, rows)


def _row(
        table: str, columns: tuple[str, ...], tree: Tree, place: Place
        ) -> tuple[str, tuple[Printed, ...]]:
    _exactly(tree, ('row', 'unit', 'printed'), place)
    title = _text(tree['row'], place / 'row')
    units = ([tree['unit']] * len(columns) if isinstance(tree['unit'], str)
             else _texts(tree['unit'], place / 'unit'))
    texts = _texts(tree['printed'], place / 'printed')
    for key, values in (('unit', units), ('printed', texts)):
        if len(values) != len(columns):
            raise ConfigError(
                f'{place / key} has {len(values)} values, must have {len(columns)}, one for each '
                'column')
    where = table.replace('_', ' ').capitalize()
    return title, tuple(
        Printed(where, f'{title}, {column}', text,
                _value(text, unit, place / 'printed'), unit)
        for column, text, unit in zip(columns, texts, units))


def _value(text: str, unit: str, place: Place) -> float | None:
    if unit == TEXT or text in NO_NUMBERS:
        return None
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise ConfigError(f'{place} = {text!r}, must be a number with < or > before it or a '
                          'note (*, or in parentheses) behind it')
    return float(match['digits'].replace(',', ''))


def _exactly(tree: Tree, keys: tuple[str, ...], place: Place) -> None:
    refuse_unknown(tree, keys, place)
    for key in keys:
        if key not in tree:
            raise ConfigError(place.has(f'lacks {key}'))


def _texts(value: Any, place: Place) -> list[str]:
    if not isinstance(value, list):
        raise ConfigError(f'{place} = {value!r}, must be a list')
    return [_text(item, place) for item in value]


def _text(value: Any, place: Place) -> str:
    if not isinstance(value, str) or not value:
        raise ConfigError(f'{place} = {value!r}, must be a text (in quotes if it is a number)')
    return value
