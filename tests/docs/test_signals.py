"""docs/signals.md says what the samples have."""

from isa_ros.scripting.run import load
from scripts import write_signals

PAGE = write_signals.PAGE.read_text(encoding='utf-8')


def test_its_tables_are_those_of_the_code() -> None:
    """`python scripts/write_signals.py` after a change of a sample."""
    assert write_signals.page(PAGE) == PAGE


def test_a_changed_unit_is_noticed() -> None:
    changed = PAGE.replace('| J', '| Nm', 1)
    assert changed != PAGE and write_signals.page(changed) == PAGE


def test_it_has_every_signal_of_a_result() -> None:
    names = {name.rpartition('.')[2] for name in load('leg', duration=0.001).simulate()}
    assert all(f'`{name}`' in PAGE for name in names)
