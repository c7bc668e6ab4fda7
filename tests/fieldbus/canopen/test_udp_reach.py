"""Where a bus over UDP can be reached from, and that more than this host has to be asked for."""

from dataclasses import replace
import subprocess
import sys

from isa_ros.errors import ConfigError
from isa_ros.fieldbus.canopen import udp_reach
from isa_ros.fieldbus.canopen.udp_reach import reach_of
from isa_ros.fieldbus.lines import refuse_unusable
from isa_ros.fieldbus.request import CANOPEN, MIT
import pytest
from tests.fieldbus.ethercat.namespace import ROOT
from tests.fieldbus.test_lines import REQUEST, with_arguments

GROUP, GROUP_6 = '239.74.163.2', 'ff15::1'
NAMESPACE = ('unshare', '--map-root-user', '--net')


@pytest.fixture
def exposed(monkeypatch):
    monkeypatch.setattr(udp_reach, '_ipv4_interfaces', lambda: iter(['wlan0', 'eth0', 'eth0']))
    monkeypatch.setattr(udp_reach, '_ipv6_interfaces', lambda: iter(['eth1']))


@pytest.mark.parametrize(('group', 'bound'), [
    (GROUP, 'binds UDP 0.0.0.0:43113, group 239.74.163.2: whoever reaches eth0, wlan0 c'),
    (GROUP_6, 'binds UDP [::]:43113, group ff15::1: whoever reaches eth1 c')])
def test_other_hosts_have_to_be_asked_for(exposed, group, bound):
    with pytest.raises(ConfigError) as refused:
        reach_of('udp_multicast', group, False)
    text = str(refused.value)
    assert bound in text and 'unshare -rn' in text and '--allow-network' in text
    assert bound in reach_of('udp_multicast', group, True)


@pytest.mark.parametrize(('interface', 'channel'), [
    ('socketcan', GROUP), ('virtual', 'x'), ('udp_multicast', 'not-a-group.invalid')])
def test_other_interfaces_have_no_reach(exposed, interface, channel):
    assert reach_of(interface, channel, False) == ''


@pytest.mark.parametrize('bus', [CANOPEN, MIT])
def test_both_buses_refuse_before_anything_is_opened(exposed, bus):
    asked = with_arguments(
        replace(REQUEST, bus=bus), interface='udp_multicast', channel=GROUP, first_node=1)
    with pytest.raises(ConfigError, match='--allow-network'):
        refuse_unusable(asked, [], 1_000_000)


@pytest.mark.parametrize(('address', 'state', 'is_exposed'), [
    ('', 'up', False), ('192.0.2.1/24', 'up', True), ('192.0.2.1/24', 'down', False)])
def test_an_interface_with_an_address_is_what_counts(address, state, is_exposed):
    """In a namespace: the loopback and two virtual interfaces, one with an address or not."""
    commands = [f'ip link {one}' for one in (
        'set lo up', 'add ecs type veth peer name ecm', 'set ecs up', f'set ecm {state}')]
    if address:
        commands.append(f'ip address add {address} dev ecm')
    commands.append(f'{sys.executable} -c "from isa_ros.fieldbus.canopen.udp_reach import '
                    f'reach_of; print(reach_of(\'udp_multicast\', \'{GROUP}\', True))"')
    try:
        ended = subprocess.run([*NAMESPACE, 'sh', '-ec', '; '.join(commands)], cwd=ROOT,
                               capture_output=True, text=True)
    except OSError as error:
        pytest.skip(str(error))
    if 'unshare' in ended.stderr:
        pytest.skip(ended.stderr)
    assert ('whoever reaches ecm can send frames' in ended.stdout) == is_exposed, ended.stderr
    assert ('no interface but the loopback' in ended.stdout) != is_exposed
