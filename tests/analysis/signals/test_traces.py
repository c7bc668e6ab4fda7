"""Signals of a bag as arrays."""

from pathlib import Path

from isa_ros.analysis.signals.signals import read_signals
from isa_ros.analysis.signals.traces import Column, read_traces
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from tests.bag.golden import rewrite

GOLDEN = Bag(Path(__file__).parents[2] / 'golden' / 'leg_touchdown')
TOPIC = '/kfe/references'


def test_arrays_hold_what_the_messages_say():
    """Every value read by its offset equals the decoded message's."""
    wanted = [Column('both', ('position[0]', 'position[3]'), is_row=True),
              Column('stamp', ('header.stamp.nanosec',)),
              Column('shifted', ('position[1]',), offset=-3.0)]
    trace = read_traces(GOLDEN, {TOPIC: wanted})[TOPIC]
    messages = [m for m in GOLDEN.messages() if m.topic == TOPIC]
    assert len(messages) == 81 == len(trace.times) == GOLDEN.counts[TOPIC]
    for k, message in enumerate(messages):
        decoded = decode(message.data, JointState)
        assert trace.times[k] == message.t_ns
        assert list(trace.values['both'][k]) == [decoded.position[0], decoded.position[3]]
        assert trace.values['stamp'][k] == decoded.header.stamp.nanosec
        assert trace.values['shifted'][k] == decoded.position[1] - 3.0


def test_time_is_that_of_the_samples():
    """81 samples, 1 ms apart."""
    assert np.diff(read_signals(GOLDEN).time) == pytest.approx(np.full(80, 1e-3))


def test_what_the_messages_do_not_have_is_left_out():
    trace = read_traces(GOLDEN, {'/none': [], TOPIC: [
        Column('one', ('position[1]',)), Column('more', ('position[1]', 'position[9]'), True)]})
    assert list(trace) == [TOPIC] and list(trace[TOPIC].values) == ['one']


def longer(topic, sequence, data):
    """Append a byte to a message of tick 40."""
    return data + bytes((topic, sequence) == (TOPIC, 40))


def renamed(topic, sequence, data):
    """Change a byte of the frame in the head of a message of tick 40."""
    return data.replace(b'position', b'Position') if (topic, sequence) == (TOPIC, 40) else data


@pytest.mark.parametrize('change', [longer, renamed])
def test_messages_of_two_layouts_are_refused(tmp_path, change):
    """A longer message cannot be read with the first one's offsets; texts are no signals."""
    other = Bag(rewrite(GOLDEN, tmp_path / 'bag', change))
    with pytest.raises(BagError, match='/kfe/references: the messages change their layout'):
        read_traces(other, {TOPIC: [Column('one', ('position[1]',))]})
    assert len(read_traces(other, {TOPIC: []})[TOPIC].times) == 81
