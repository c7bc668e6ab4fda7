"""
Write the table of docs/real_data.md about a log that is late against its commands.

    python -m scripts.write_late_log

searches the parameters of our own machine six times, some ten minutes of CPU.
"""

from collections.abc import Sequence
from pathlib import Path
import sys
from tempfile import TemporaryDirectory

import isa_ros
from isa_ros.analysis.measured.against import against
from isa_ros.analysis.measured.closing import Closed, DELAY, MACHINE
from isa_ros.core.atomic_file import replace_file
from isa_ros.core.units import MILLI
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
from scripts.made_measurement import measured
from scripts.write_real_data import PAGE, place_of, TRUE

PART = 'late log'
DURATION_S = 3.0
DELAYS_MS = 0.0, 1.0, 2.0


def searched(delay_ms: float, free: Sequence[str]) -> Sequence[Closed]:
    """Return what is found of our own machine, whose log is late."""
    changes = {place_of(key): TRUE[key] for key in MACHINE}
    with TemporaryDirectory() as folder:
        path, mapping = measured(
            Path(folder), DURATION_S, changes, clock_ppm=0.0, delay=delay_ms * MILLI)
        return against(path, mapping, isa_ros.load('rig_linear'), free).parameters


def row(delay_ms: float, found: Sequence[Closed]) -> list[str]:
    """Return the cells of a search; an interval without the true value is bold."""
    cells = {own.free.key: _cell(own, TRUE.get(own.free.key, delay_ms)) for own in found}
    return [f'{delay_ms:g} ms', *(cells.get(key, 'not free') for key in (DELAY, *MACHINE))]


def _cell(own: Closed, true: float) -> str:
    text = f'{own.value:.4g} +- {own.half_width:.2g}'
    return text if abs(own.value - true) <= own.half_width else f'**{text}**'


def main() -> int:
    """Write the table; print each row."""
    rows = [['log is late by', f'`{DELAY}`', *(
        f'`{key}`, {TRUE[key]:g}' for key in MACHINE)]]
    for delay_ms in DELAYS_MS:
        for free in (MACHINE, (*MACHINE, DELAY)):
            rows.append(row(delay_ms, searched(delay_ms, free)))
            print(*rows[-1], sep=' | ', flush=True)
    page = with_parts(PAGE.read_text(encoding='utf-8'), {PART: markdown(rows)})
    replace_file(PAGE, page.encode(), is_durable=False)
    print(PAGE)
    return 0


if __name__ == '__main__':
    sys.exit(main())
