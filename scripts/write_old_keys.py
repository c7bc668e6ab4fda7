"""
Write the table of docs/versions.md: what an older bag may lack, and the value that is meant.

    python scripts/write_old_keys.py
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from isa_ros.actuator.link import LinkSheet
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.runs.run_config import RUN
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import InText, Key, parameter_rows, ParameterSet, REQUIRED
from isa_ros.config.text.parameter_sets import members
from isa_ros.loads.sheets import LocalLoad
from isa_ros.surroundings.supply import SupplySheet
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'versions.md'
NAME = 'NAME'
"""Stands for the name of an actuator or supply."""


def lacked() -> list[tuple[str, str, str]]:
    """
    Return key, value where a bag lacks it, and meaning, in the order of the files.

    A key of several kinds of a section is there once for each value.
    """
    found = [*_of_table(RUN, '')]
    for hint, place in ((SupplySheet, f'supplies.{NAME}'), (ActuatorSheet, f'actuators.{NAME}'),
                        (LocalLoad, f'actuators.{NAME}.load'),
                        (LinkSheet, f'actuators.{NAME}.link')):
        found += _of_sets(hint, place)
    return list(dict.fromkeys(found))


def _of_table(table: KeyTable, place: str) -> Iterator[tuple[str, str, str]]:
    for key in table.keys:
        path = f'{place}{key.name}'
        if key.in_text is InText.IF_ANY and key.default not in (REQUIRED, None):
            yield path, _words(key), key.meaning
        section = key.kind.section if isinstance(key.kind, NamedSections) else key.kind
        if isinstance(section, KeyTable):
            name = f'.{NAME}' if isinstance(key.kind, NamedSections) else ''
            yield from _of_table(section, f'{path}{name}.')


def _of_sets(hint: Any, place: str) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of a parameter set, or of all kinds of a union."""
    if isinstance(hint, type):
        yield from _of_set(hint, place)
        return
    for cls in members(hint).values():
        yield from _of_set(cls, place)


def _of_set(cls: Any, place: str) -> Iterator[tuple[str, str, str]]:
    for name, key in parameter_rows(cls).items():
        path = f'{place}.{name}'
        if key.default is not REQUIRED:
            yield path, _words(key), key.meaning
        if isinstance(key.kind, ParameterSet) and key.kind.hint is not None:
            yield from _of_sets(key.kind.hint, path)


def _words(key: Key) -> str:
    return key.default_words or str(key.default)


def page(text: str) -> str:
    """Return the text of the page with the table of today."""
    rows = [(f'`{key}`', value, meaning) for key, value, meaning in lacked()]
    return with_parts(text, {'lacked': markdown([('key', 'value', 'meaning'), *rows])})


if __name__ == '__main__':
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
