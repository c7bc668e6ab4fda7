"""When a device has a message: the same by Python and compiled."""

from isa_ros.core.device import is_status_due
from isa_ros.core.kernel import kernel
import pytest

TICK, NOW = 1_000_000, 5_000_000


@kernel
def compiled(since, age, is_stale, t_ns, tick_start_ns):
    return is_status_due(since, age, is_stale, t_ns, tick_start_ns)


@pytest.mark.parametrize('since, age, is_stale, t_ns, is_due', [
    (0.0, 0.0, 0.0, 0, True),                       # t = 0
    (0.003, 0.0, 0.0, NOW, False),                  # before the tick, which begins at 4 ms
    (0.003989, 0.0, 0.0, NOW, False), (0.003991, 0.0, 0.0, NOW, True),      # half a step early
    (0.0045, 0.0, 0.0, NOW, True),
    (0.001, 0.0035, 0.0, NOW, True),                # has arrived over a link
    (0.001, 0.0035, 1.0, NOW, False),               # of an REU that has stopped
    (0.0, 0.0, 0.0, 999_000_000, False), (0.0, 0.0, 0.0, 1_000_000_000, True),
    (0.0, 0.0, 0.0, 1_001_000_000, False)])
def test_a_status_is_due_when_it_has_changed_and_at_each_second(
        since, age, is_stale, t_ns, is_due):
    given = since, age, is_stale, t_ns, max(0, t_ns - TICK)
    assert is_status_due(*given) is is_due
    assert compiled(*given) == is_due
