"""The packaged middleware settings are used where the user has set none."""

from xml.etree import ElementTree

from isa_ros.nodes.environment import PROFILE, set_defaults
import pytest

NAMESPACE = '{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}'


@pytest.fixture(autouse=True)
def empty_directory(tmp_path, monkeypatch):
    """Fast DDS also reads a profile in the working directory."""
    monkeypatch.chdir(tmp_path)


def test_defaults():
    environment: dict[str, str] = {}
    set_defaults(environment)
    assert environment == {
        'FASTRTPS_DEFAULT_PROFILES_FILE': str(PROFILE),
        'FASTDDS_DEFAULT_PROFILES_FILE': str(PROFILE),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


@pytest.mark.parametrize('name', [
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
    'RMW_FASTRTPS_USE_QOS_FROM_XML', 'ROS_DISCOVERY_SERVER'])
def test_profile_of_the_user_is_kept(name):
    environment = {name: 'mine'}
    set_defaults(environment)
    assert environment == {name: 'mine', 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


def test_profile_in_the_directory_is_kept(tmp_path):
    (tmp_path / 'DEFAULT_FASTRTPS_PROFILES.xml').touch()
    environment: dict[str, str] = {}
    set_defaults(environment)
    assert environment == {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


@pytest.mark.parametrize(
    'name', ['ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_LOCALHOST_ONLY', 'ROS_STATIC_PEERS'])
def test_discovery_of_the_user_is_kept(name):
    environment = {name: 'mine'}
    set_defaults(environment)
    assert environment[name] == 'mine'
    assert environment.get('ROS_AUTOMATIC_DISCOVERY_RANGE', 'mine') == 'mine'


@pytest.mark.parametrize(('path', 'text'), [
    ('discovery_config/leaseDuration/sec', '5'),
    ('discovery_config/initialAnnouncements/count', '40'),
    ('discovery_config/initialAnnouncements/period/nanosec', '50000000'),
    ('data_writer/times/heartbeatPeriod/nanosec', '5000000')])
def test_profile_says_what_was_measured(path, text):
    """The values of lockstep.md, fact 6."""
    steps = './/' + '/'.join(f'{NAMESPACE}{step}' for step in path.split('/'))
    assert ElementTree.parse(PROFILE).findtext(steps) == text
