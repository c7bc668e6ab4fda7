"""The shipped URDFs fit the messages of the shipped legs: joints by name, frames as links."""

from pathlib import Path
from xml.etree import ElementTree

from isa_ros.config.assembly import surroundings_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.run.output import packer_of
from isa_ros.tick.exchange import Rows
from msg_adapters.cdr_reader import decode, message_class
import pytest

URDF = Path(__file__).resolve().parents[4] / 'urdf'
LEGS = ('leg', 'hyq_leg', 'rig_knee')


def published(config: str):
    """Return the URDF of a run's leg and its messages with a header at t = 0, by topic."""
    run = load_run(find(config, CONFIG))
    rows = Rows(len(run.actuators), surroundings_of(run))
    rows.published.applied['kinds'] = 1
    packer = packer_of(run, rows.published)
    packer.pack(0, 0, {})
    messages = {}
    for index, data in packer.all_messages():
        message = decode(bytes(data), message_class(packer.topics[index].type_name))
        if hasattr(message, 'header'):
            messages[packer.topics[index].name] = message
    return ElementTree.parse(URDF / f'{run.leg.model}_leg.urdf').getroot(), messages


@pytest.mark.parametrize('config', LEGS)
def test_the_joint_states_hold_every_joint_that_is_not_fixed(config):
    robot, messages = published(config)
    joints = {joint.get('name') for joint in robot.iter('joint') if joint.get('type') != 'fixed'}
    names = list(messages['/joint_states'].name)
    assert set(names) == joints and len(names) == len(joints) == 4


@pytest.mark.parametrize('config', LEGS)
def test_every_frame_is_a_link(config):
    """Of the coordinator and of every actuator; diagnostics are of no place."""
    robot, messages = published(config)
    links = {link.get('name') for link in robot.iter('link')}
    assert len(messages) == 4 + 3 * 7
    frames = {topic: message.header.frame_id for topic, message in messages.items()
              if topic != '/diagnostics'}
    assert {topic: frame for topic, frame in frames.items() if frame not in links} == {}


@pytest.mark.parametrize('config', LEGS)
def test_no_joint_has_the_name_of_an_actuator(config):
    """The entry `kfe` is the actuator's in m, `kfe_joint` the joint's in rad."""
    _, messages = published(config)
    actuators = {name for topic, message in messages.items()
                 if topic.count('/') == 2 and topic.endswith('/joint_states')
                 for name in message.name}
    assert actuators == {'haa', 'hfe', 'kfe'}
    assert not actuators & set(messages['/joint_states'].name)
