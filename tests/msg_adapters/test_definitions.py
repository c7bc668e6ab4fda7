"""Message definitions: rosbag2's text and REP-2011's hash, from installed packages."""

import json

from msg_adapters.definitions import definition, DefinitionError, SEPARATOR
import pytest
from rosbags.typesys import get_types_from_msg, get_typestore, Stores

TYPES = (
    'sensor_msgs/msg/JointState', 'geometry_msgs/msg/WrenchStamped', 'nav_msgs/msg/Odometry',
    'sensor_msgs/msg/FluidPressure', 'rosgraph_msgs/msg/Clock',
    'diagnostic_msgs/msg/DiagnosticArray', 'sensor_msgs/msg/Imu',
)
STORE = get_typestore(Stores.ROS2_JAZZY)


@pytest.mark.parametrize('type_name', TYPES)
def test_hash_equals_that_of_rosbags(type_name):
    assert definition(type_name).type_hash == STORE.hash_rihs01(type_name)


@pytest.mark.parametrize('type_name', TYPES)
def test_text_declares_the_fields_of_the_type_and_its_dependencies(type_name):
    """Parsed by another library, the text gives that library's own definitions."""
    parsed = get_types_from_msg(definition(type_name).text, type_name)
    assert type_name in parsed
    assert {name: fields for name, (_, fields) in parsed.items()} == {
        name: STORE.fielddefs[name][1] for name in parsed}


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Return a function that installs a .msg file under AMENT_PREFIX_PATH."""
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/nonexistent:{tmp_path}')

    def install(package, name, text):
        folder = tmp_path / 'share' / package / 'msg'
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f'{name}.msg').write_bytes(text.encode())
        hashes = [{'type_name': f'{package}/msg/{name}', 'hash_string': f'RIHS01_{name}'}]
        (folder / f'{name}.json').write_text(json.dumps({'type_hashes': hashes}))

    return install


def test_dependencies_follow_depth_first_sorted_and_once(installed):
    """rosbag2_cpp LocalMessageDefinitionSource::get_full_text, rule by rule."""
    installed('a_msgs', 'Root', 'z_msgs/Last z  # used first\nMiddle[3] m\nfloat64 x 1.0\n')
    installed('a_msgs', 'Middle', 'Leaf leaf\nstring<=5[] names\n')
    installed('a_msgs', 'Leaf', 'int32 A=1\nint32 value')
    installed('z_msgs', 'Last', 'a_msgs/Leaf leaf\nbool[<=4] flags\n')
    assert definition('a_msgs/msg/Root').text == (
        'z_msgs/Last z  # used first\nMiddle[3] m\nfloat64 x 1.0\n'
        f'\n{SEPARATOR}\nMSG: a_msgs/Middle\nLeaf leaf\nstring<=5[] names\n'
        f'\n{SEPARATOR}\nMSG: a_msgs/Leaf\nint32 A=1\nint32 value'
        f'\n{SEPARATOR}\nMSG: z_msgs/Last\na_msgs/Leaf leaf\nbool[<=4] flags\n')
    assert SEPARATOR == 80 * '='


def test_sourced_prefix_comes_before_the_python_package(installed):
    installed('sensor_msgs', 'JointState', 'float64 overlaid\n')
    found = definition('sensor_msgs/msg/JointState')
    assert found == ('float64 overlaid\n', 'RIHS01_JointState')


def test_without_a_sourced_prefix_the_python_package_leads_there(monkeypatch):
    monkeypatch.delenv('AMENT_PREFIX_PATH', raising=False)
    assert definition('rosgraph_msgs/msg/Clock').text.endswith('uint32 nanosec\n')


def test_type_that_is_not_installed_is_named():
    with pytest.raises(DefinitionError, match='no_msgs/msg/Thing: no share/no_msgs/msg/Thing.m'):
        definition('no_msgs/msg/Thing')


def test_hash_of_another_type_is_not_taken(installed, tmp_path):
    installed('a_msgs', 'Root', 'float64 x\n')
    installed('a_msgs', 'Other', 'float64 x\n')
    share = tmp_path / 'share' / 'a_msgs' / 'msg'
    (share / 'Other.json').replace(share / 'Root.json')
    with pytest.raises(DefinitionError, match='no type hash of a_msgs/msg/Root'):
        definition('a_msgs/msg/Root')
