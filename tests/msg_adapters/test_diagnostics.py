"""DiagnosticArray: bytes that ROS reads, and values read back."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from msg_adapters import diagnostics
from msg_adapters.cdr import CdrError
import pytest
from rclpy.serialization import deserialize_message

STATUSES = (
    diagnostics.Status(
        'knee', 'oil and energy', '0.2 l', {'oil drawn (l)': 0.2, 'work (J)': -1e9}),
    diagnostics.Status('knee', 'device', 'enabled', {'state': 'enabled'}, DiagnosticStatus.WARN))


def test_ros_reads_the_statuses():
    message = deserialize_message(diagnostics.pack(1_500_000_000, STATUSES), DiagnosticArray)
    first, second = message.status
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 500_000_000)
    assert (first.name, first.hardware_id, first.message) == (
        'knee: oil and energy', 'knee', '0.2 l')
    assert first.level == DiagnosticStatus.OK and second.level == DiagnosticStatus.WARN
    assert [(pair.key, pair.value) for pair in first.values] == [
        ('oil drawn (l)', '0.2'), ('work (J)', '-1e+09')]


def test_values_are_those_of_one_task():
    data = diagnostics.pack(0, STATUSES)
    assert diagnostics.values(data, 'device') == {'knee': {'state': 'enabled'}}
    assert diagnostics.values(data, 'oil and energy')['knee']['work (J)'] == '-1e+09'
    assert diagnostics.values(data, 'other') == {}


def test_what_is_no_array_is_refused():
    with pytest.raises(CdrError):
        diagnostics.values(b'\x00\x01\x00\x00\x01', 'device')
