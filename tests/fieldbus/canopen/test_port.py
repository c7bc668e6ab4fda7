"""The door to python-can: what cannot be opened, and frames of other kinds."""

import sys
import uuid

import can
from isa_ros.errors import ConfigError, RunError
from isa_ros.fieldbus.canopen.line import canopen_line
from isa_ros.fieldbus.canopen.port import CanPort, IGNORED
import pytest
from tests.fieldbus.canopen.toy import ToyDrive
from tests.fieldbus.canopen.virtual_bus import STEP_NS, virtual_master


def refusal(interface: str, channel: str) -> str:
    with pytest.raises(ConfigError) as refused:
        CanPort(interface, channel, 1_000_000)
    text = str(refused.value)
    assert '\n' not in text
    return text


def test_an_unknown_interface_is_answered_with_those_of_python_can():
    text = refusal('socketcam', 'can0')
    assert 'interface = socketcam' in text and 'socketcan, ' in text


def test_a_bus_that_is_not_there_is_one_line():
    text = refusal('socketcan', 'isa_no_can')
    assert text.startswith('interface = socketcan, channel = isa_no_can: the bus cannot be opened')


def test_a_channel_that_is_no_group_is_one_line():
    assert 'cannot be opened' in refusal('udp_multicast', 'not-a-group.invalid')


def test_a_missing_library_is_named_with_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, 'can', None)
    with pytest.raises(ConfigError, match=r"python-can.*pip install -e '.\[canopen\]'"):
        CanPort('virtual', 'any', 1_000_000)


def test_an_interface_without_its_own_library_is_one_line(monkeypatch):
    monkeypatch.setattr('can.interfaces.slcan.serial', None)
    assert "pip install 'python-can[serial]'" in refusal('slcan', '/dev/null')
    monkeypatch.setattr('can.interfaces.udp_multicast.utils.msgpack', None)
    assert "pip install -e '.[canopen]'" in refusal('udp_multicast', '239.74.163.2')


@pytest.mark.parametrize('message', [
    can.Message(arbitration_id=0x181, is_remote_frame=True, is_extended_id=False),
    can.Message(arbitration_id=0x80, is_extended_id=True),
    can.Message(arbitration_id=0x80, is_fd=True, is_extended_id=False),
    can.Message(is_error_frame=True, is_extended_id=False)])
def test_frames_of_other_kinds_are_ignored_and_counted(message):
    with virtual_master([ToyDrive()]) as master:
        master.command(1)
        assert not master.send_message(message)
        assert master.line.port.ignored == 1


@pytest.mark.parametrize('error', [ValueError('x'), can.CanOperationError('no message')])
def test_what_python_can_cannot_decode_is_ignored(monkeypatch, error):
    port = CanPort('virtual', uuid.uuid4().hex, 1_000_000)
    monkeypatch.setattr(port._bus, 'recv', raising(error))
    assert port.receive(0.0) == IGNORED
    port.close()


def test_a_lost_bus_ends_the_run(monkeypatch):
    port = CanPort('virtual', 'gone', 1_000_000)
    monkeypatch.setattr(port._bus, 'recv', raising(OSError(19, 'No such device')))
    with pytest.raises(RunError, match='CAN bus virtual gone is lost: .*No such device'):
        port.receive(0.0)
    port.close()


def test_a_bus_that_takes_no_frame_is_counted(monkeypatch):
    port = CanPort('virtual', 'full', 1_000_000)
    monkeypatch.setattr(port._bus, 'send', raising(can.CanOperationError('buffer full')))
    port.send(0x181, b'')
    assert port.unsent == 1
    port.close()


def raising(error):
    def call(*_: object, **__: object) -> None:
        raise error
    return call


@pytest.mark.parametrize(('first_node', 'last'), [(0, 0), (127, 128)])
def test_nodes_are_1_to_127(first_node, last):
    devices = [ToyDrive(str(k)) for k in range(last - first_node + 1)]
    with pytest.raises(ConfigError, match=f'nodes {first_node} to {last}, must be 1 to 127'):
        canopen_line(devices, 'virtual', 'nodes', 10 * STEP_NS, first_node=first_node)
