"""Which topics of a source are due at a tick."""

from isa_ros.core.topic import Topic
from isa_ros.run.live import every_tick, LivePeriods
import pytest

TOPICS = [Topic(name, 'std_msgs/msg/Bool') for name in ('/a', '/b', '/c')]
PERIODS = {'/a': 1, '/b': 2, '/c': 3}


@pytest.mark.parametrize(('tick', 'expected'), [
    (0, [0, 1, 2]), (1, [0]), (2, [0, 1]), (3, [0, 2]), (6, [0, 1, 2]), (7, [0])])
def test_a_topic_is_due_at_the_multiples_of_its_period(tick, expected):
    live = LivePeriods(lambda topic: PERIODS[topic.name], TOPICS)
    assert live.due(tick) == expected
    assert live.due(tick, (1, 2)) == [slot for slot in expected if slot]


def test_without_periods_what_is_wanted_is_due():
    """The same object: a tick pays nothing."""
    live, wanted = LivePeriods(every_tick, TOPICS), [2]
    assert live.due(1, wanted) is wanted
    assert live.due(1) is None
