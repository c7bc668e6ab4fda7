"""
Write the tables of docs/protection.md from the declared conditions and the shipped models.

    python scripts/write_protection.py
"""

from collections.abc import Iterator
import math
from pathlib import Path
from typing import Any

from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.config.models.catalogue import actuator_model, DEFAULT_PRESET
from isa_ros.config.text.parameter_sets import build
from isa_ros.core.conditions import BITS, CONDITIONS
from isa_ros.core.parameter import defaults
from isa_ros.core.record import row_record
from isa_ros.core.units import of_coordinate, quantity
from isa_ros.reu.protection_sheet import levels_of, Protection
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
import numpy as np

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'protection.md'
MODELS = ('isa_v2', 'isa_v5', 'smart_manifold')
SHOWN = {'Pa': ('MPa', 1e6), 'A': ('mA', 1e-3), 'm': ('mm', 1e-3), 's': ('ms', 1e-3)}
"""Unit and its size in SI, for units whose usual values are not readable in SI."""


def shown(value: float, unit: str) -> str:
    """Return a value in SI with a readable unit: ``23.1 MPa``."""
    name, size = SHOWN.get(unit, (unit, 1.0))
    return quantity(f'{value / size:.4g}', name)


def conditions() -> list[str]:
    """Return the lines of the table of what is compared, with what, and the defaults."""
    sheet = defaults(Protection)
    rows = [['bit', 'condition', 'compared', 'parts of', 'warning', 'trip', 'delay', 'reaction']]
    for name, bit in BITS.items():
        condition = CONDITIONS[bit]
        own: Any = levels_of(sheet).get(name)
        warning, trip, delay, reaction = (
            (0.0, 0.0, 0.0, getattr(sheet, f'{name}_reaction')) if own is None
            else (own.warning, own.trip, own.delay_ms, own.reaction))
        rows.append([
            str(bit), f'`{name}`', condition.quantity, condition.rating_words or '-',
            *(_level(value, condition.is_above) for value in (warning, trip)),
            f'{delay:g} ms' if delay else '-', reaction])
    return markdown(rows)


def _level(value: float, is_above: bool) -> str:
    return f'{">" if is_above else "<"} {value:g}' if value else 'off'


def levels() -> list[str]:
    """Return the lines of the table of the levels in SI that the defaults are, by model."""
    return markdown([['condition', *MODELS], *_levels()])


def _levels() -> Iterator[list[str]]:
    found = {name: _constants(name) for name in MODELS}
    for name, bit in BITS.items():
        cells = []
        for protection, is_rotary in found.values():
            unit = of_coordinate(CONDITIONS[bit].unit, is_rotary)
            values = [float(protection.sign[bit] * level[bit])
                      for level in (protection.warning, protection.trip)]
            cells.append(', '.join(
                shown(value, unit) if math.isfinite(value) else 'off' for value in values))
        if set(cells) != {'off, off'}:
            yield [f'`{name}`', *cells]


def _constants(model: str) -> tuple[np.record, bool]:
    found = actuator_model(model, 'model')
    sheet = build(ActuatorSheet, found.with_preset(DEFAULT_PRESET, 'preset'), found.place)
    row = row_record(actuator_record(sheet, 0))
    return row.reu.protection, sheet.is_rotary


def page(text: str) -> str:
    """Return the text of the page with the tables of today."""
    return with_parts(text, {'conditions': conditions(), 'levels': levels()})


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(PAGE.read_text(encoding='utf-8')), encoding='utf-8')
    print(PAGE)


if __name__ == '__main__':
    main()
