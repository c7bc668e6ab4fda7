"""
Write the tables of stops in docs/protection.md from runs, about half a minute.

    python scripts/write_stops.py
"""

from pathlib import Path

from isa_ros.analysis.stops.page import leg_table, table
from isa_ros.text.marked import with_parts

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'protection.md'


def main() -> None:
    """Write the page."""
    text = PAGE.read_text(encoding='utf-8')
    PAGE.write_text(with_parts(text, {'stops': table(), 'leg stops': leg_table()}),
                    encoding='utf-8')
    print(PAGE)


if __name__ == '__main__':
    main()
