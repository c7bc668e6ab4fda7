"""Comparing runs: the first differing tick, topic and field, with both values."""

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.replay.compare import compare_bags, Comparer
from isa_ros.replay.difference import FirstDifference
from isa_ros.replay.tolerances import Tolerance, Tolerances
from mcap.writer import CompressionType, Writer
from msg_adapters.cdr import encode
from msg_adapters.definitions import definition
from msg_adapters.joint_state import joint_state
import numpy as np
import pytest
from tests.bag.recorded import NAMES, PROVENANCE, record, STEP_NS, tick_messages, TOPICS
from tests.replay.ticks import difference, N, produced


def test_equal_runs_are_reported_with_what_was_compared(bag, tmp_path):
    report = compare_bags(bag, Bag(record(tmp_path / 'again', N)))
    assert report.is_equal
    assert (report.ticks, report.messages, report.end_ns) == (
        N, bag.n_messages, (N - 1) * STEP_NS)
    assert str(report) == 'equal: 20 ticks, 141 messages, up to t = 0.019000 s'


def test_first_difference_names_tick_topic_field_and_both_values(bag):
    found = difference(bag, produced(force=3.0, spool=4.0))
    assert found == FirstDifference(
        7, 7 * STEP_NS, '/hip/joint_states', 'effort[0]', np.sin(0.7 + 2), 3.0)
    assert str(found) == (
        'tick 7 (t = 0.007000 s), /hip/joint_states, effort[0]: '
        f'expected {float(np.sin(0.7 + 2))!r}, got 3.0')


def test_difference_of_one_bit_counts(bag):
    value = float(np.nextafter(np.sin(0.7 + 5), 1.0))
    found = difference(bag, produced(spool=value))
    assert (found.topic, found.field, found.actual) == ('/hip/valve', 'position[0]', value)


def test_report_says_that_runs_differ_and_where(bag, tmp_path):
    report = compare_bags(bag, Bag(record(tmp_path / 'other', N, {3: {'spool': 1.0}})))
    assert not report.is_equal
    assert str(report).startswith('differ: tick 3 (t = 0.003000 s), /hip/valve, position[0]: ')


def test_earlier_tick_wins_over_earlier_topic(tmp_path, bag):
    other = Bag(record(tmp_path / 'other', N, {5: {'spool': 1.0}, 6: {'position': 1.0}}))
    found = compare_bags(bag, other).difference
    assert (found.tick, found.topic) == (5, '/hip/valve')


def test_negative_zero_is_not_zero(tmp_path):
    bag = Bag(record(tmp_path / 'rig', 1, {0: {'spool': 0.0}}))
    found = difference(bag, [(0, 0, tick_messages(0, spool=-0.0))])
    assert (str(found.expected), str(found.actual)) == ('0.0', '-0.0')


def test_not_a_number_equals_itself_only(tmp_path):
    bag = Bag(record(tmp_path / 'rig', 1, {0: {'spool': np.nan}}))
    wide = Tolerances({('/hip/valve', 'position'): Tolerance(absolute=1e9)})
    assert difference(bag, [(0, 0, tick_messages(0, spool=np.nan))]) is None
    assert difference(bag, [(0, 0, tick_messages(0, spool=1.0))], wide) is not None


def test_missing_message_is_named(bag):
    ticks = produced()
    t_ns, sequence, messages = ticks[7]
    ticks[7] = (t_ns, sequence, [m for m in messages if NAMES[m[0]] != '/hip/pressure_a'])
    assert difference(bag, ticks) == FirstDifference(
        7, 7 * STEP_NS, '/hip/pressure_a', 'message', 'present', 'absent')


def test_message_too_many_is_named(bag):
    """An applied setpoint that the recorded run does not have."""
    ticks = produced()
    t_ns, sequence, messages = ticks[7]
    extra = [m for m in tick_messages(0) if NAMES[m[0]] == '/hip/applied_setpoint']
    ticks[7] = (t_ns, sequence, [*messages, *extra])
    assert difference(bag, ticks) == FirstDifference(
        7, 7 * STEP_NS, '/hip/applied_setpoint', 'message', 'absent', 'present')


def test_run_that_ends_early_is_named(bag):
    assert difference(bag, produced(N - 2)) == FirstDifference(
        N - 2, (N - 2) * STEP_NS, 'bag', 'tick', 'present', 'absent')


def test_run_that_goes_on_is_named(bag):
    assert difference(bag, produced(N + 2)) == FirstDifference(
        N, N * STEP_NS, 'bag', 'tick', 'absent', 'present')


def test_other_time_is_named(bag):
    ticks = [(t_ns + 1 if k == 7 else t_ns, k, messages) for t_ns, k, messages in produced()]
    assert difference(bag, ticks) == FirstDifference(
        7, 7 * STEP_NS, 'bag', 'log_time', 7 * STEP_NS, 7 * STEP_NS + 1)


def test_other_length_is_named_before_elements(bag):
    ticks = produced()
    t_ns, sequence, messages = ticks[0]
    longer = encode(joint_state('hip', ['hip', 'knee']))
    index = NAMES.index('/hip/joint_states')
    ticks[0] = (t_ns, sequence, [(k, longer if k == index else d) for k, d in messages])
    found = difference(bag, ticks)
    assert (found.field, found.expected, found.actual) == ('name.length', 1, 2)


def foreign(path, data):
    """Write one /hip/valve message with the official writer, as another type or padding."""
    type_name, message = data
    with path.open('wb') as file:
        writer = Writer(file, compression=CompressionType.NONE)
        writer.start('ros2')
        text = definition(type_name).text.encode()
        schema = writer.register_schema(type_name, 'ros2msg', text)
        writer.add_message(writer.register_channel('/hip/valve', 'cdr', schema), 0, message, 0)
        writer.finish()
    return Bag(path)


def test_padding_is_no_difference(tmp_path):
    """Middlewares leave padding uninitialised, so only fields are compared."""
    data = dict(tick_messages(0))[NAMES.index('/hip/valve')]
    text = b'hip/spool\0'  # 10 bytes, padded to 12
    padded = bytearray(data)
    padded[data.index(text) + len(text)] = 0xff
    bags = [foreign(tmp_path / f'{k}.mcap', ('sensor_msgs/msg/JointState', bytes(d)))
            for k, d in enumerate((data, padded))]
    assert compare_bags(*bags).is_equal


def test_other_type_is_named(tmp_path):
    data = dict(tick_messages(0))[NAMES.index('/hip/valve')]
    bags = [foreign(tmp_path / f'{k}.mcap', (type_name, data)) for k, type_name in enumerate(
        ('sensor_msgs/msg/JointState', 'geometry_msgs/msg/WrenchStamped'))]
    found = compare_bags(*bags).difference
    assert (found.topic, found.field, found.actual) == (
        '/hip/valve', 'type', 'geometry_msgs/msg/WrenchStamped')


def test_tolerance_admits_what_it_says_and_no_more(bag):
    exact = float(np.sin(0.7 + 5))
    tolerances = Tolerances({('/hip/valve', 'position'): Tolerance(absolute=1e-3)})
    assert difference(bag, produced(spool=exact + 0.9e-3), tolerances) is None
    assert difference(bag, produced(spool=exact + 1.1e-3), tolerances).field == 'position[0]'


def test_tolerance_of_one_topic_leaves_the_others_strict(bag):
    tolerances = Tolerances({('/hip/valve', 'position'): Tolerance(absolute=10.0)})
    found = difference(bag, produced(spool=1.0, current=1.0), tolerances)
    assert (found.topic, found.field) == ('/hip/valve', 'effort[0]')


def test_cut_bag_compares_up_to_its_end(tmp_path):
    """A replay of a bag cut short ends at the end of the bag."""
    path = record(tmp_path / 'rig', 700)
    path.write_bytes(path.read_bytes()[:-100_000])
    bag = Bag(path)
    ticks = [tick for tick in produced(700) if tick[0] <= bag.end_ns]
    comparer = Comparer(bag, [topic.name for topic in TOPICS])
    for tick in ticks:
        comparer.write_tick(*tick)
    report = comparer.finish()
    assert report.is_equal
    assert report.ticks == len(ticks) == 500


def test_absent_messages_are_counted_by_topic(bag, tmp_path):
    path = tmp_path / 'without'
    rewrite_without(bag, path, '/hip/valve', from_tick=5)
    valve, = compare_bags(bag, Bag(path)).topics
    assert (valve.n_messages, valve.first, valve.largest) == (N - 5, FirstDifference(
        5, 5 * STEP_NS, '/hip/valve', 'message', 'present', 'absent'), None)


def rewrite_without(bag, path, topic, from_tick):
    """Record a bag again, without one topic from a tick on."""
    with BagWriter(path, TOPICS, PROVENANCE) as writer:
        for tick in bag.ticks():
            writer.write_tick(tick.t_ns, tick.sequence, [
                (NAMES.index(m.topic), m.data) for m in tick.messages
                if m.topic != topic or tick.sequence < from_tick])


@pytest.mark.parametrize(('n', 'first'), [
    (N - 3, (N - 3, 'present', 'absent')), (N + 3, (N, 'absent', 'present'))])
def test_shorter_and_longer_runs_are_compared_to_the_end_of_both(bag, tmp_path, n, first):
    other = Bag(record(tmp_path / 'other', n, {5: {'spool': 1.0}}))
    report = compare_bags(bag, other)
    whole, valve = report.topics
    assert (whole.topic, whole.n_messages) == ('bag', 3)
    assert (whole.first.tick, whole.first.expected, whole.first.actual) == first
    assert (valve.topic, valve.n_messages, report.difference) == ('/hip/valve', 1, valve.first)


def test_ticks_of_other_times_do_not_hide_what_follows(bag):
    """A tick that only one run has is counted; the others are compared."""
    comparer = Comparer(bag, NAMES, is_to_end=True)
    for t_ns, k, messages in produced():
        comparer.write_tick(
            t_ns + (k == 7), k, tick_messages(k, spool=1.0) if k == 9 else messages)
    whole, valve = comparer.finish().topics
    assert (whole.n_messages, whole.first.field) == (2, 'log_time')
    assert (valve.first.tick, valve.n_messages) == (9, 1)


def test_the_first_difference_is_the_first_by_time_over_many_ticks(tmp_path):
    """Messages are compared many ticks at a time; the earlier tick wins all the same."""
    n = 600
    bag = Bag(record(tmp_path / 'rig', n))
    other = Bag(record(tmp_path / 'other', n, {
        299: {'spool': 9.0}, 300: {'position': 9.0}, 599: {'spool': 99.0}}))
    report = compare_bags(bag, other)
    assert (report.difference.tick, report.difference.topic) == (299, '/hip/valve')
    assert [(topic.topic, topic.n_messages) for topic in report.topics] == [
        ('/hip/valve', 2), ('/hip/joint_states', 1)]
    assert report.topics[0].largest.tick == 599


def test_nothing_is_compared_after_the_first_difference_unless_asked(tmp_path):
    """A replay can stop early."""
    n = 600
    bag = Bag(record(tmp_path / 'rig', n))
    comparer = Comparer(bag, NAMES)
    for tick in range(n):
        comparer.write_tick(tick * STEP_NS, tick, tick_messages(
            tick, **({'spool': 9.0} if tick >= 10 else {})))
        if comparer.difference is not None:
            break
    assert tick < 300
    assert comparer.difference.tick == 10
    report = comparer.finish()
    assert report.difference == comparer.difference and report.ticks == tick + 1


def test_topics_have_the_order_of_their_first_differences_and_the_larger_first(tmp_path):
    """Of two that differ from one tick on, the one whose numbers are farther apart."""
    bag, other = (Bag(record(tmp_path / name, N, changes)) for name, changes in (
        ('one', {}), ('other', {3: {'spool': 9.0}, 2: {'position': 9.0}})))
    assert [own.topic for own in compare_bags(bag, other).topics] == [
        '/hip/joint_states', '/hip/valve']
    least = Bag(record(tmp_path / 'least', N, {2: {'position': 1e-9, 'spool': 9.0}}))
    report = compare_bags(bag, least)
    assert [own.topic for own in report.topics] == ['/hip/valve', '/hip/joint_states']
    assert report.difference == report.topics[0].first


def test_diagnostics_are_told_of_last(bag):
    """They say in words what follows of other topics, also where they differ at t = 0."""
    comparer = Comparer(bag, NAMES, is_to_end=True)
    comparer.note(FirstDifference(0, 0, '/diagnostics', 'status[0].message', 'a', 'b'))
    comparer.note(FirstDifference(5, 5 * STEP_NS, '/hip/valve', 'position[0]', 1.0, 2.0))
    for t_ns, k, messages in produced():
        comparer.write_tick(t_ns, k, messages)
    report = comparer.finish()
    assert [own.topic for own in report.topics] == ['/hip/valve', '/diagnostics']
    assert report.difference == report.topics[0].first
