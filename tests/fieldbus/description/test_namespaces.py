"""Files for masters of a run of two robots: names of drivers and files have no slash."""

from pathlib import Path
from xml.etree import ElementTree

from isa_ros.cli.main import main
from isa_ros.config.text.yaml_text import dump
import pytest
from tests.fieldbus.description.ec_driver import EcDriver
import yaml

FLAT = [f'{robot}_{joint}' for robot in ('r1', 'r2') for joint in ('haa', 'hfe', 'kfe')]
PLACED = [name.replace('_', '/') for name in FLAT]


@pytest.fixture(scope='module')
def made(tmp_path_factory) -> Path:
    """Return the folder with all files of two legs, made by the command."""
    folder = tmp_path_factory.mktemp('made')
    (folder / 'pair.yaml').write_text(dump({'name': 'pair', 'step_ms': 5.0, 'robots': {
        name: {'file': 'leg'} for name in ('r1', 'r2')}}))
    for option, name in (('--esi', 'pair.xml'), ('--eds', 'pair.eds'),
                         ('--ros2-control', 'ethercat'), ('--ros2-canopen', 'canopen')):
        assert main(['bus', 'describe', str(folder / 'pair.yaml'), option,
                     str(folder / name)]) == 0
    return folder


def test_every_device_has_its_files_in_one_folder(made):
    assert {path.name for path in (made / 'ethercat').iterdir()} == {
        *(f'{name}.yaml' for name in FLAT), 'ros2_control.urdf.xacro'}
    assert {path.name for path in (made / 'canopen').iterdir()} == {
        *(f'{name}.eds' for name in FLAT), 'bus.yml', 'ros2_control.urdf.xacro'}
    assert {path.name for path in made.glob('*.eds')} == {f'pair_{name}.eds' for name in FLAT}


def test_the_tags_name_joints_and_files_that_are_there(made):
    for folder in ('ethercat', 'canopen'):
        tag = ElementTree.parse(made / folder / 'ros2_control.urdf.xacro').getroot()
        joints = [joint.get('name') for joint in tag.iter('joint')]
        assert joints == FLAT, folder
    for name in FLAT:
        driver = EcDriver(made / 'ethercat' / 'ros2_control.urdf.xacro', name)
        assert driver.config['product_id'] > 0


def test_the_nodes_of_a_can_have_their_names_and_files(made):
    bus = yaml.safe_load((made / 'canopen' / 'bus.yml').read_text())
    nodes = {name: own for name, own in bus.items() if name not in ('options', 'master')}
    assert list(nodes) == FLAT
    assert [own['node_id'] for own in nodes.values()] == list(range(1, 7))
    for name, own in nodes.items():
        assert Path(own['dcf']) == made / 'canopen' / f'{name}.eds' and Path(own['dcf']).is_file()


def test_what_a_master_shows_has_the_names_of_the_run(made):
    """The ESI has the slaves once a kind, an EDS the device that it is of."""
    assert ElementTree.parse(made / 'pair.xml').getroot().tag == 'EtherCATInfo'
    for flat, placed in zip(FLAT, PLACED):
        assert placed in (made / f'pair_{flat}.eds').read_text()
