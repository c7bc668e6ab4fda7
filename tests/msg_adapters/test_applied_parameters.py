"""What was tuned, as rcl_interfaces/ParameterEvent and back."""

from hypothesis import given, settings, strategies as st
from isa_ros.errors import SetpointError
from msg_adapters.applied_parameters import applied_parameters, tuned_values, TYPE
from msg_adapters.cdr import CdrError, encode
from msg_adapters.cdr_reader import decode
import pytest
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterValue
from tests.msg_adapters.test_cdr import STORE, to_rosbags

T_NS = 2_000_000_003
VALUES = st.dictionaries(
    st.sampled_from(['force.kp', 'force.limit', 'position.force_out', 'spool.compensation.knee']),
    st.floats(allow_nan=False))


@given(values=VALUES, t_ns=st.integers(0, 2**31 * 10**9 - 1))
@settings(deadline=None)
def test_values_come_back_bit_for_bit(values, t_ns):
    data = applied_parameters('hip', values, t_ns)
    again = tuned_values(data, 'hip')
    assert list(again) == list(values)
    assert list(map(repr, again.values())) == list(map(repr, values.values()))


@given(values=VALUES)
@settings(deadline=None)
def test_bytes_equal_those_of_rosbags(values):
    data = applied_parameters('hip', values, T_NS)
    assert data == bytes(STORE.serialize_cdr(to_rosbags(decode(data, ParameterEvent)), TYPE))


def test_the_event_names_node_time_and_changes():
    event = decode(applied_parameters('hip', {'force.kp': 1e-7}, T_NS), ParameterEvent)
    assert (event.node, event.stamp.sec, event.stamp.nanosec) == ('/hip', 2, 3)
    assert not event.new_parameters and not event.deleted_parameters
    parameter, = event.changed_parameters
    assert (parameter.name, parameter.value.type, parameter.value.double_value) == (
        'force.kp', 3, 1e-7)


KP = Parameter(name='force.kp', value=ParameterValue(type=3, double_value=1.0))


@pytest.mark.parametrize(('event', 'message'), [
    (ParameterEvent(node='/knee', changed_parameters=[KP]), "hip: .* of node '/knee'"),
    (ParameterEvent(node='/hip', new_parameters=[KP]), "must be changes of '/hip'"),
    (ParameterEvent(node='/hip', changed_parameters=[KP, KP]), 'name force.kp twice'),
    (ParameterEvent(node='/hip', changed_parameters=[Parameter(
        name='force.kp', value=ParameterValue(type=4, string_value='1'))]),
     r'force.kp is of type 4, must be 3 \(double\)')])
def test_what_no_actuator_says_is_refused(event, message):
    with pytest.raises(SetpointError, match=message):
        tuned_values(encode(event), 'hip')


def test_bytes_that_are_no_event_are_refused():
    with pytest.raises(CdrError):
        tuned_values(b'\x00\x01\x00\x00\x01', 'hip')
