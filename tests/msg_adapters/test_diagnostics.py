"""DiagnosticArray: bytes that ROS reads, and values read back."""

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from msg_adapters import diagnostics
from msg_adapters.cdr import CdrError, encode
import pytest
from rclpy.serialization import deserialize_message
from std_msgs.msg import Header

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


@pytest.mark.parametrize('n', range(3))
def test_the_bytes_are_those_of_the_message(n):
    """Also of none, of names of any length and letters, and of a status without values."""
    names = ['\u0141okie\u0107', 'hip', 'a', ''][n:]
    statuses = [diagnostics.Status(name, 'task', name * k, {key: 0.1 + k for key in names[:k]},
                                   bytes([k])) for k, name in enumerate(names)]
    for some in (statuses, statuses[:1], []):
        assert diagnostics.pack(2_000_000_007 + n, some) == encode(DiagnosticArray(
            header=Header(stamp=Time(sec=2, nanosec=7 + n)),
            status=[DiagnosticStatus(
                level=own.level, name=f'{own.hardware}: task', message=own.message,
                hardware_id=own.hardware,
                values=[KeyValue(key=key, value=f'{value:.9g}')
                        for key, value in own.values.items()]) for own in some]))


def test_values_are_those_of_one_task():
    data = diagnostics.pack(0, STATUSES)
    assert diagnostics.values(data, 'device') == {'knee': {'state': 'enabled'}}
    assert diagnostics.values(data, 'oil and energy')['knee']['work (J)'] == '-1e+09'
    assert diagnostics.values(data, 'other') == {}


def test_what_is_no_array_is_refused():
    with pytest.raises(CdrError):
        diagnostics.values(b'\x00\x01\x00\x00\x01', 'device')
