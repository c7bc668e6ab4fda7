"""Differences of a topic: the first one, and the largest deviation beyond its tolerance."""

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.core.signals import SAMPLE
from isa_ros.core.topic import Topic
from isa_ros.replay.compare import compare_bags, Comparer
from isa_ros.replay.tolerances import Tolerance, Tolerances
from msg_adapters.cdr import encode
from msg_adapters.joint_state import joint_state, TYPE as JOINT_STATE
import numpy as np
from tests.bag.recorded import PROVENANCE, record, STEP_NS
from tests.replay.ticks import N


def test_every_topic_has_its_first_difference_and_its_largest_deviation(bag, tmp_path):
    """In proportion to the values of the field: 0.1 of a spool below 1 beats 1.0 of 50."""
    other = Bag(record(tmp_path / 'other', N, {
        3: {'spool': 0.25}, 5: {'spool': 100.0, 'current': 1.0}, 9: {'position': 0.0}}))
    report = compare_bags(bag, other)
    topics = {topic.topic: topic for topic in report.topics}
    assert list(topics) == ['/hip/valve', '/hip/joint_states']
    assert topics['/hip/joint_states'].n_messages == 1
    valve = topics['/hip/valve']
    assert (valve.n_messages, valve.first) == (2, report.difference)
    assert valve.first.actual == 0.25
    assert valve.largest == (
        5, 5 * STEP_NS, 'position[0]', float(np.sin(0.5 + 5)), 100.0, None)
    assert valve.largest.size == 100.0 - np.sin(0.5 + 5)


def test_deviation_is_in_proportion_to_its_field(bag, tmp_path):
    """1 % of a field of thousands is less than all of a field of ones."""
    changed = [Bag(record(tmp_path / name, N, {4: {'spool': 1000.0 + more, 'current': more}}))
               for name, more in (('one', 0.0), ('other', 10.0))]
    valve, = compare_bags(*changed).topics
    assert (valve.first.field, valve.largest.field, valve.largest.size) == (
        'position[0]', 'effort[0]', 10.0)


def test_admitted_values_are_no_deviation(bag, tmp_path):
    """The largest deviation is one that its tolerance does not admit."""
    other = Bag(record(tmp_path / 'other', N, {3: {'spool': 100.0}, 5: {'current': 3.0}}))
    tolerances = Tolerances({('/hip/valve', 'position'): Tolerance(absolute=200.0),
                             ('/hip/valve', 'effort'): Tolerance(0.125, 0.25)})
    valve, = compare_bags(bag, other, tolerances).topics
    exact = float(np.sin(0.5 + SAMPLE.names.index('current')))
    assert (valve.n_messages, valve.first.tick, valve.largest.field) == (1, 5, 'effort[0]')
    assert valve.largest.allowed == 0.125 + 0.25 * abs(exact)


def test_value_that_is_no_number_is_the_largest_deviation(bag, tmp_path):
    other = Bag(record(tmp_path / 'other', N, {3: {'spool': np.nan}, 5: {'spool': 1e300}}))
    valve, = compare_bags(bag, other).topics
    assert (valve.largest.tick, valve.largest.size) == (3, np.inf)


def test_first_differences_are_those_of_messages_compared_one_by_one(tmp_path):
    """A text that changes within a block of ticks leaves no columns; the fields are the same."""
    def ticks(value):
        return [(k * STEP_NS, k, [(0, encode(joint_state('hip', [name])))])
                for k, name in enumerate(['hip', 'hip', value, 'hip'])]

    with BagWriter(tmp_path / 'rig', [Topic('/x', JOINT_STATE)], PROVENANCE) as writer:
        for tick in ticks('hip'):
            writer.write_tick(*tick)
    comparer = Comparer(Bag(tmp_path / 'rig'), ['/x'], is_to_end=True)
    for tick in ticks('hop'):
        comparer.write_tick(*tick)
    found, = comparer.finish().topics
    assert (found.n_messages, found.first.tick, found.first.field, found.first.actual) == (
        1, 2, 'name[0]', 'hop')
    assert found.largest is None
