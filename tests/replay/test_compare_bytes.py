"""Bytes of messages that are in no field, and messages that cannot be decoded."""

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.errors import BagError
from isa_ros.replay.compare import compare_bags, Comparer
from isa_ros.replay.difference import FirstDifference
from isa_ros.replay.tolerances import Tolerance, Tolerances
import numpy as np
import pytest
from tests.bag.recorded import NAMES, PROVENANCE, record, STEP_NS, tick_messages, TOPICS
from tests.replay.ticks import difference, produced


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
    assert found == FirstDifference(7, 7 * STEP_NS, '/hip/valve', f'byte {at}', 0xff, 0)
    assert difference(bag, produced(), tolerances) is None


@pytest.mark.parametrize('tolerances', [None, LOOSE])
def test_bytes_after_the_last_field_are_a_difference(tmp_path, tolerances):
    bag = with_valve(tmp_path / 'rig', lambda data: data + b'\0')
    found = exactly(bag, produced(), tolerances)
    size = len(dict(tick_messages(7))[VALVE])
    assert found == FirstDifference(7, 7 * STEP_NS, '/hip/valve', 'bytes', size + 1, size)


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
    assert exactly(bag, ticks) == FirstDifference(7, 7 * STEP_NS, '/clock', 'sequence', 7, 8)
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
