"""Ticks of the small recorded run, as a run produces them, compared with its bag."""

from isa_ros.replay.compare import Comparer
from tests.bag.recorded import NAMES, STEP_NS, tick_messages

N = 20


def difference(bag, ticks, tolerances=None):
    """Return the first difference of a bag and (t_ns, sequence, messages) of each tick."""
    comparer = Comparer(bag, NAMES, tolerances)
    for tick in ticks:
        comparer.write_tick(*tick)
    return comparer.finish().difference


def produced(n=N, **changed):
    """Return the ticks as a run produces them; ``changed`` applies to tick 7."""
    return [
        (k * STEP_NS, k, tick_messages(k, **(changed if k == 7 else {}))) for k in range(n)]
