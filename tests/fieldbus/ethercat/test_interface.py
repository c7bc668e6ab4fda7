"""Interfaces that cannot be used are refused in one line that says what helps."""

import socket

from isa_ros.errors import ConfigError
from isa_ros.fieldbus.ethercat import interface
import pytest
from tests.fieldbus.ethercat.namespace import run


def test_interfaces_that_cannot_be_used_are_refused():
    found = run('interface')
    absent, empty, long, loopback, down, removed = found['errors']
    for text in (absent, empty, long):
        assert 'does not exist, must be one of lo, ecm, ecs' in text
        assert 'ip link add ecs type veth peer name ecm' in text
    assert loopback == 'interface lo is the loopback, must be an Ethernet interface'
    assert down == 'interface ecs is down, must be up: ip link set ecs up'
    assert removed == 'interface ecs was removed during the run'


def test_an_interface_that_goes_down_is_a_lost_link():
    found = run('interface')
    assert found['lost links'] == [1, 0, 0, 0]
    assert not found['tick']


def test_without_permission_the_message_says_how_to_get_it(monkeypatch):
    def refuse(*_: object) -> None:
        raise PermissionError
    present = socket.if_nameindex()[0][1]
    monkeypatch.setattr(interface, '_flags', lambda name: 1)
    monkeypatch.setattr(interface.socket, 'socket', refuse)
    with pytest.raises(ConfigError, match=r'needs CAP_NET_RAW: run in a namespace .*unshare -rn'):
        interface.open_interface(present)


def test_another_system_than_linux_is_refused(monkeypatch):
    monkeypatch.delattr(socket, 'AF_PACKET')
    with pytest.raises(ConfigError, match='raw sockets of Linux'):
        interface.open_interface('eth0')
