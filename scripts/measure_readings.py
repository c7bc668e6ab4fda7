"""
Measure the readings of Table 4 and write their tables into docs/paper-errata.md.

    python scripts/measure_readings.py [--page FILE]

Takes about a minute. The tables stand between two markers of the page; the rest is not touched.
"""

import argparse
from pathlib import Path

from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
from isa_ros.validation.readings import (
    LINEAR, linear_readings, ROTARY, rotary_readings, table)

PAGE = Path(__file__).parents[1] / 'docs' / 'paper-errata.md'
MARKERS = {ROTARY: 'readings of the rotary column', LINEAR: 'readings of the ISA v5 column'}


def main() -> None:
    """Measure, and replace the tables of the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--page', type=Path, default=PAGE, metavar='FILE')
    page_path = parser.parse_args().page
    page = page_path.read_text(encoding='utf-8')
    for model, readings in ((ROTARY, rotary_readings()), (LINEAR, linear_readings())):
        lines = markdown(table(readings, model))
        print('\n'.join(lines))
        page = with_parts(page, {MARKERS[model]: lines})
    page_path.write_text(page, encoding='utf-8')


if __name__ == '__main__':
    main()
