"""The tables of docs/device.md are the data that the device runs on."""

from pathlib import Path

from isa_ros.core.device import EVENTS
from isa_ros.reu.transitions import TRANSITIONS
import pytest
from scripts import draw_device

PAGE = Path(__file__).parents[2] / 'docs' / 'device.md'


def test_the_tables_of_the_page_are_those_of_the_device():
    """Else run scripts/draw_device.py."""
    text = PAGE.read_text(encoding='utf-8')
    assert draw_device.with_tables(text) == text
    for lines in (draw_device.state_table(), draw_device.mode_table()):
        assert '\n'.join(lines) in text


def test_a_changed_transition_changes_the_page(monkeypatch):
    text = PAGE.read_text(encoding='utf-8')
    monkeypatch.setattr(draw_device, 'TRANSITIONS', TRANSITIONS[:-1])
    assert draw_device.with_tables(text) != text


@pytest.mark.parametrize('event', EVENTS)
def test_every_event_has_its_cause(event):
    assert draw_device.EVENT_WORDS[event]
