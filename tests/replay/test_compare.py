"""Comparing runs: the first differing tick, topic and field, with both values."""

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.errors import BagError
from isa_ros.replay.compare import compare_bags, Comparer, Difference
from isa_ros.replay.tolerances import Tolerance, Tolerances
from mcap.writer import CompressionType, Writer
from msg_adapters.cdr import encode
from msg_adapters.definitions import definition
from msg_adapters.joint_state import joint_state
import numpy as np
import pytest
from tests.bag.recorded import NAMES, PROVENANCE, record, STEP_NS, tick_messages, TOPICS

N = 20


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return a bag of N ticks."""
    return Bag(record(tmp_path_factory.mktemp('recorded') / 'rig', N))


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


def test_equal_runs_are_reported_with_what_was_compared(bag, tmp_path):
    report = compare_bags(bag, Bag(record(tmp_path / 'again', N)))
    assert report.is_equal
    assert (report.ticks, report.messages, report.end_ns) == (
        N, bag.n_messages, (N - 1) * STEP_NS)
    assert str(report) == 'equal: 20 ticks, 141 messages, up to t = 0.019000 s'


def test_first_difference_names_tick_topic_field_and_both_values(bag):
    found = difference(bag, produced(force=3.0, spool=4.0))
    assert found == Difference(
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
    assert difference(bag, ticks) == Difference(
        7, 7 * STEP_NS, '/hip/pressure_a', 'message', 'present', 'absent')


def test_message_too_many_is_named(bag):
    """An applied setpoint that the recorded run does not have."""
    ticks = produced()
    t_ns, sequence, messages = ticks[7]
    extra = [m for m in tick_messages(0) if NAMES[m[0]] == '/hip/applied_setpoint']
    ticks[7] = (t_ns, sequence, [*messages, *extra])
    assert difference(bag, ticks) == Difference(
        7, 7 * STEP_NS, '/hip/applied_setpoint', 'message', 'absent', 'present')


def test_run_that_ends_early_is_named(bag):
    assert difference(bag, produced(N - 2)) == Difference(
        N - 2, (N - 2) * STEP_NS, 'bag', 'tick', 'present', 'absent')


def test_run_that_goes_on_is_named(bag):
    assert difference(bag, produced(N + 2)) == Difference(
        N, N * STEP_NS, 'bag', 'tick', 'absent', 'present')


def test_other_time_is_named(bag):
    ticks = [(t_ns + 1 if k == 7 else t_ns, k, messages) for t_ns, k, messages in produced()]
    assert difference(bag, ticks) == Difference(
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


def exactly(bag, ticks, tolerances=None):
    """Return the first difference, also of bytes that are in no field."""
    comparer = Comparer(bag, NAMES, tolerances, is_exact=True)
    for tick in ticks:
        comparer.write_tick(*tick)
    return comparer.finish().difference


VALVE = NAMES.index('/hip/valve')
LOOSE = Tolerances({('/hip/valve', 'position'): Tolerance(absolute=1e-3)})


def with_valve(directory, changed):
    """Return a bag whose message 7 of /hip/valve has other bytes."""
    with BagWriter(directory, TOPICS, PROVENANCE) as writer:
        for t_ns, tick, messages in produced():
            writer.write_tick(t_ns, tick, [
                (k, changed(data) if (k, tick) == (VALVE, 7) else data) for k, data in messages])
    return Bag(directory)


def padded(data):
    """Change the padding behind the name of the joint: 10 bytes, padded to 12."""
    at = data.index(b'hip/spool\0') + 10
    return data[:at] + b'\xff' + data[at + 1:]


@pytest.mark.parametrize('tolerances', [None, LOOSE])
def test_padding_is_a_difference_where_bytes_are_compared(tmp_path, tolerances):
    """With a tolerance for values too: it is none for other bytes."""
    bag = with_valve(tmp_path / 'rig', padded)
    found = exactly(bag, produced(), tolerances)
    at = dict(tick_messages(7))[VALVE].index(b'hip/spool\0') + 10
    assert found == Difference(7, 7 * STEP_NS, '/hip/valve', f'byte {at}', 0xff, 0)
    assert difference(bag, produced(), tolerances) is None


@pytest.mark.parametrize('tolerances', [None, LOOSE])
def test_bytes_after_the_last_field_are_a_difference(tmp_path, tolerances):
    bag = with_valve(tmp_path / 'rig', lambda data: data + b'\0')
    found = exactly(bag, produced(), tolerances)
    size = len(dict(tick_messages(7))[VALVE])
    assert found == Difference(7, 7 * STEP_NS, '/hip/valve', 'bytes', size + 1, size)


def test_another_not_a_number_is_a_difference_of_bytes(tmp_path):
    """Its value is the same text, its bytes are not."""
    quiet, other = np.float64(np.nan).tobytes(), b'\1' + np.float64(np.nan).tobytes()[1:]
    bag = Bag(record(tmp_path / 'rig', 1, {0: {'spool': np.nan}}))
    messages = [(k, data.replace(quiet, other)) for k, data in tick_messages(0, spool=np.nan)]
    assert difference(bag, [(0, 0, messages)]) is None
    assert exactly(bag, [(0, 0, messages)]).field.startswith('byte ')


def test_a_tolerance_still_admits_values(tmp_path, bag):
    assert exactly(bag, produced(spool=float(np.sin(0.7 + 5)) + 0.9e-3), LOOSE) is None


def test_another_sequence_number_is_a_difference(bag):
    """Bags of other recorders count by themselves, so that comparing two bags ignores it."""
    ticks = [(t_ns, k + (k == 7), messages) for t_ns, k, messages in produced()]
    assert exactly(bag, ticks) == Difference(7, 7 * STEP_NS, '/clock', 'sequence', 7, 8)
    assert difference(bag, ticks) is None
    assert exactly(bag, produced()) is None


def test_a_cut_message_is_located(tmp_path):
    """Bag, number of the message, topic, tick and time."""
    bag = with_valve(tmp_path / 'rig', lambda data: data[:50])
    number = sum(len(tick_messages(k)) for k in range(7)) + [
        k for k, _ in tick_messages(7)].index(VALVE) + 1
    with pytest.raises(BagError) as refused:
        difference(bag, produced())
    assert str(refused.value).startswith(
        f'{bag.path}: message {number} of {bag.n_messages}, /hip/valve, tick 7 (t = 0.007000 s): '
        'JointState: ')


def test_a_cut_message_of_the_other_run_is_located(tmp_path, bag):
    other = with_valve(tmp_path / 'rig', lambda data: data[:50])
    with pytest.raises(BagError, match=f'/hip/valve, tick 7, compared with {bag.path}: JointSta'):
        compare_bags(bag, other)


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
