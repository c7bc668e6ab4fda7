"""Drags of a slider: each is one event of its run."""

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.replay.replay import replay
from isa_ros.run.coordinator import Interrupted
import pytest
from tests.view.test_running import Lived, setpoint


def test_a_drag_is_one_event_of_the_run(tmp_path):
    """Of each slider with its last value, once it has stood still for half a second."""
    drag = {10 + k: [setpoint('position', 0.030 + 0.001 * k)] for k in range(4)}
    lived = Lived(tmp_path / 'bag', drag | {
        12: [*drag[12], setpoint('effort', 71.0)], 100: [setpoint('position', 0.044)]},
        duration=0.2)
    events = [own for own in isa_ros.read(lived.bag.path).events if own.kind == 'change']
    assert [(own.source, own.what) for own in events] == [
        ('ram', 'by the page, effort = 71'), ('ram', 'by the page, position = 0.033'),
        ('ram', 'by the page, position = 0.044')]
    assert [own.t_s for own in events] == [0.012, 0.013, 0.1]   # when they took effect
    assert replay(lived.bag).is_equal


@pytest.mark.parametrize('ends', ['whole', 'stopped', 'restarted'])
def test_a_drag_at_the_end_is_an_event_of_its_run(tmp_path, ends):
    """However the run ends before the slider stood still; of the run after it it is none."""
    orders = {10: [setpoint('position', 0.031)], 12: [setpoint('position', 0.032)]}
    if ends == 'restarted':
        orders[14] = [{'what': 'restart'}]
    try:
        Lived(tmp_path / 'bag', orders, duration=0.02, stops_at=14 if ends == 'stopped' else None)
    except Interrupted:
        assert ends == 'stopped'
    event, = (own for own in isa_ros.read(tmp_path / 'bag').events if own.kind == 'change')
    assert (event.source, event.what, event.t_s) == ('ram', 'by the page, position = 0.032', 0.012)
    assert replay(Bag(tmp_path / 'bag')).is_equal
    assert (tmp_path / 'bag_2').exists() == (ends == 'restarted')
    if ends == 'restarted':
        assert not [own for own in isa_ros.read(tmp_path / 'bag_2').events if own.kind == 'change']
