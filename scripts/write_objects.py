"""
Write the tables of docs/objects.md from the object table of the leg's last actuator.

    python scripts/write_objects.py
"""

from pathlib import Path

import isa_ros
from isa_ros.fieldbus.description.object_page import with_tables
from isa_ros.fieldbus.device.devices import devices_of

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'objects.md'


def written(page: str) -> str:
    """Return the page with its tables anew."""
    run = isa_ros.load('leg').configuration
    return with_tables(page, devices_of(run)[-1], devices_of(run, 'cia408')[-1])


if __name__ == '__main__':
    PAGE.write_text(written(PAGE.read_text()))
