"""Signals of a bag as arrays."""

from pathlib import Path

from isa_ros.analysis.signals.traces import columns, read_traces
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import JointState

GOLDEN = Path(__file__).parents[2] / 'golden' / 'leg_touchdown'


def test_arrays_hold_what_the_messages_say():
    """Every value read by its offset equals the decoded message's."""
    (run, problem), traces = read_traces(GOLDEN)
    assert problem == ''
    assert [actuator.name for actuator in run.actuators] == ['haa', 'hfe', 'kfe']
    messages = [m for m in Bag(GOLDEN).messages() if m.topic == '/kfe/references']
    trace = traces['/kfe/references']
    assert len(messages) == 81
    for k, message in enumerate(messages):
        decoded = decode(message.data, JointState)
        assert trace.t[k] == message.t_ns * 1e-9
        assert [trace[f'position[{j}]'][k] for j in range(4)] == list(decoded.position)
        assert trace['header.stamp.nanosec'][k] == decoded.header.stamp.nanosec


def test_time_is_that_of_the_samples():
    """81 samples, 1 ms apart."""
    _, traces = read_traces(GOLDEN)
    assert np.diff(traces['/clock'].t) == pytest.approx(np.full(80, 1e-3))


def test_messages_of_two_layouts_are_refused():
    """A longer message cannot be read with the first one's offsets."""
    first = next(m.data for m in Bag(GOLDEN).messages() if m.topic == '/kfe/references')
    with pytest.raises(BagError, match='somewhere: the messages change their layout'):
        columns([first, first + b'\0'], 'sensor_msgs/msg/JointState', 'somewhere')
