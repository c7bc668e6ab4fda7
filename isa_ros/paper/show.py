"""`isa paper`: the paper's values, each with its place in the paper."""

from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.paper.printed import Printed, statements, Table, tables
from isa_ros.text.table import aligned

STATEMENTS = 'statements'


def describe(name: str | None) -> str:
    """
    Return every table and statement as text, or only the named one.

    Raises
    ------
    ConfigError
        Neither a table nor a statement has this name.

    """
    names = [*tables(), STATEMENTS, *statements()]
    if name is not None and name not in names:
        raise ConfigError(f'{name} is neither a table nor a statement; '
                          f'{alternatives(name, names)}')
    blocks = [_table(table) for table in tables().values() if name in (None, table.name)]
    chosen = [
        (key, _with_unit(value), value.where, value.what)
        for key, value in statements().items() if name in (None, STATEMENTS, key)]
    if chosen:
        blocks.append('\n'.join(['statements', *aligned(chosen)]))
    return '\n\n'.join(blocks)


def _table(table: Table) -> str:
    rows = [('', *table.columns)]
    rows += [
        (title, *map(_with_unit, cells))
        for title, cells in table.rows.items()]
    return '\n'.join([f'{table.name}: {table.caption}', *aligned(rows)])


def _with_unit(printed: Printed) -> str:
    has_unit = printed.value is not None and printed.unit != '1'
    return f'{printed.text} {printed.unit}' if has_unit else printed.text
