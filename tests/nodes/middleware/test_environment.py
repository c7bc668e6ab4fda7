"""The packaged middleware settings are used if the user has set none."""

from pathlib import Path
from xml.etree import ElementTree

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.environment import (
    defaults, finds_other_hosts, LOCALHOST_PROFILE, NETWORK_PROFILE, set_defaults)
import pytest

NAMESPACE = '{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}'
FAST_DDS = 'rmw_fastrtps_cpp'


@pytest.fixture(autouse=True)
def empty_directory(tmp_path, monkeypatch):
    """Fast DDS also reads a profile in the working directory."""
    monkeypatch.chdir(tmp_path)


def with_profile(profile, **others):
    return {'FASTRTPS_DEFAULT_PROFILES_FILE': str(profile),
            'FASTDDS_DEFAULT_PROFILES_FILE': str(profile), **others}


def test_by_default_the_profile_alone_says_what_listens():
    """For LOCALHOST rmw_fastrtps would add UDP on every interface and shared memory."""
    environment: dict[str, str] = {}
    set_defaults(environment, FAST_DDS)
    assert environment == with_profile(
        LOCALHOST_PROFILE, ROS_AUTOMATIC_DISCOVERY_RANGE='SYSTEM_DEFAULT')


@pytest.mark.parametrize('home', [None, '/dev/null', '/dev/null/none'])
def test_without_a_home_the_logs_are_temporary(monkeypatch, tmp_path, home):
    """Else rclpy fails to initialise."""
    if home is None:
        monkeypatch.delenv('HOME', raising=False)
    else:
        monkeypatch.setenv('HOME', home)
    environment: dict[str, str] = {}
    set_defaults(environment, FAST_DDS)
    assert Path(environment.pop('ROS_LOG_DIR')).parts[-1] == 'log'
    assert environment == with_profile(
        LOCALHOST_PROFILE, ROS_AUTOMATIC_DISCOVERY_RANGE='SYSTEM_DEFAULT')
    for name in ('ROS_LOG_DIR', 'ROS_HOME'):
        own = {name: str(tmp_path)}
        set_defaults(own, FAST_DDS)
        assert own[name] == str(tmp_path) and len({'ROS_LOG_DIR', 'ROS_HOME'} & set(own)) == 1


def test_children_keep_what_their_parent_has_set():
    environment: dict[str, str] = {}
    set_defaults(environment, FAST_DDS)
    inherited = dict(environment)
    set_defaults(inherited, FAST_DDS)
    assert inherited == environment


@pytest.mark.parametrize('given', [
    {}, {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}, {'ROS_STATIC_PEERS': '192.0.2.7'}])
def test_a_process_that_goes_on_gets_its_environment_back(given):
    """A run called as a library must not set the network for its caller's later work."""
    environment = dict(given)
    with pytest.raises(RuntimeError), defaults(environment):
        assert environment['FASTDDS_DEFAULT_PROFILES_FILE']
        raise RuntimeError
    assert environment == given


def test_the_user_who_asks_for_localhost_gets_the_same():
    environment = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    set_defaults(environment, FAST_DDS)
    assert environment == with_profile(
        LOCALHOST_PROFILE, ROS_AUTOMATIC_DISCOVERY_RANGE='SYSTEM_DEFAULT')


def test_a_middleware_without_our_profile_stays_at_localhost():
    """SYSTEM_DEFAULT would be the whole subnet there."""
    environment: dict[str, str] = {}
    set_defaults(environment, 'rmw_cyclonedds_cpp')
    assert environment['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'


@pytest.mark.parametrize('name', [
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
    'RMW_FASTRTPS_USE_QOS_FROM_XML', 'ROS_DISCOVERY_SERVER'])
def test_profile_of_the_user_is_kept(name, tmp_path):
    mine = tmp_path / 'mine'
    mine.touch()
    environment = {name: str(mine)}
    set_defaults(environment, FAST_DDS)
    assert environment == {name: str(mine), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


@pytest.mark.parametrize('name', [
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE'])
def test_profile_that_is_not_there_is_refused(name, tmp_path):
    """The middleware would continue without a profile."""
    environment = {name: str(tmp_path / 'typo.xml')}
    with pytest.raises(ConfigError, match=f'^{name} = .*typo.xml: no such file$'):
        set_defaults(environment, FAST_DDS)
    assert environment == {name: str(tmp_path / 'typo.xml')}


def test_profile_in_the_directory_is_kept(tmp_path):
    (tmp_path / 'DEFAULT_FASTRTPS_PROFILES.xml').touch()
    environment: dict[str, str] = {}
    set_defaults(environment, FAST_DDS)
    assert environment == {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


@pytest.mark.parametrize(('name', 'value'), [
    ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET'), ('ROS_LOCALHOST_ONLY', '1'),
    ('ROS_STATIC_PEERS', '192.0.2.7')])
def test_network_of_the_user_is_kept(name, value):
    """Without shared memory, so that a killed node leaves nothing behind."""
    environment = {name: value}
    set_defaults(environment, FAST_DDS)
    assert environment == with_profile(
        NETWORK_PROFILE, FASTDDS_BUILTIN_TRANSPORTS='UDPv4', **{name: value})


def test_transports_of_the_user_are_kept():
    environment = {'FASTDDS_BUILTIN_TRANSPORTS': 'SHM'}
    set_defaults(environment, FAST_DDS)
    assert environment == with_profile(
        NETWORK_PROFILE, FASTDDS_BUILTIN_TRANSPORTS='SHM',
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')


@pytest.mark.parametrize('profile', [LOCALHOST_PROFILE, NETWORK_PROFILE])
@pytest.mark.parametrize(('path', 'text'), [
    ('discovery_config/leaseDuration/sec', '60'),
    ('discovery_config/initialAnnouncements/count', '40'),
    ('discovery_config/initialAnnouncements/period/nanosec', '50000000'),
    ('data_writer/times/heartbeatPeriod/nanosec', '5000000'),
    ('data_writer/times/nackResponseDelay/nanosec', '0'),
    ('data_reader/times/heartbeatResponseDelay/nanosec', '0')])
def test_profiles_say_what_was_measured(profile, path, text):
    """
    The values of lockstep.md, fact 6; with delays of 5 ms 1 % loss halves the ticks/s.

    Except the lease: of 14 nodes stopped for a lease of 2 s, 3 were never discovered again.
    """
    steps = './/' + '/'.join(f'{NAMESPACE}{step}' for step in path.split('/'))
    assert ElementTree.parse(profile).findtext(steps) == text


@pytest.mark.parametrize(('given', 'is_network'), [
    ({}, False), ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}, False),
    ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF'}, False), ({'ROS_LOCALHOST_ONLY': '1'}, False),
    ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}, True),
    ({'ROS_STATIC_PEERS': '192.0.2.1'}, True)])
def test_other_hosts_are_found_where_they_are_asked_for(given, is_network):
    """With other hosts a coordinator needs time to discover another one."""
    environment = dict(given)
    set_defaults(environment, FAST_DDS)
    assert finds_other_hosts(environment) == is_network
