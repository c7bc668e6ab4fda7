"""The page about the objects of a bus shows the present tables."""

from scripts.write_objects import PAGE, written


def test_the_tables_of_the_page_are_current():
    """Else run scripts/write_objects.py."""
    assert written(PAGE.read_text()) == PAGE.read_text()
