"""The page about CANopen shows the present frames, ranges and capacity."""

from scripts.write_canopen import PAGE, written


def test_the_tables_of_the_page_are_current():
    """Else run scripts/write_canopen.py."""
    page = PAGE.read_text(encoding='utf-8')
    assert written(page) == page
