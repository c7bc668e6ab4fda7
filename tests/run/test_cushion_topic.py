"""The topic of the pressure behind a spear: which actuators have it, and what it says."""

from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.plant.cushion_sheets import is_cushioned
from isa_ros.run.packing import Packer
from isa_ros.run.row_messages import Names, topics_of_actuator
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.testing import assert_replays
from isa_ros.tick.exchange import PublishedRows
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import FluidPressure

TOPIC = '/knee/cushion_pressure'
TYPE = 'sensor_msgs/msg/FluidPressure'
ATMOSPHERE = 101325.0


def packer(*heated: str) -> Packer:
    """Return the packer of three actuators, of which two have cushions, at 7 and 9 MPa."""
    samples = np.zeros(3, SAMPLE)
    samples['cushion_pressure'] = 8e6, 7e6, 9e6
    samples['pressure_b'] = 1e6
    rows = PublishedRows(samples, np.zeros(3, COMMAND), np.zeros(1, SUPPLY_SAMPLE), {})
    return Packer(Names(
        [('hip', True), ('knee', False), ('toe', False)], [('supply', ['pressure'])],
        heated=heated, cushioned=['knee', 'toe']), rows)


def test_only_a_cushioned_actuator_has_the_topic() -> None:
    of_all = packer()
    found = [topic for topic in of_all.topics if 'cushion' in topic.name]
    assert [own.name for own in found] == [TOPIC, '/toe/cushion_pressure']
    assert found[0].type_name == TYPE and not found[0].qos.is_kept
    assert TOPIC not in [topic.name for topic in of_all.surroundings]
    bare, own = (topics_of_actuator('~', False, False, has) for has in (False, True))
    assert {topic.name for topic in own} - {topic.name for topic in bare} == {
        '~/cushion_pressure'}


def test_the_message_is_absolute_in_the_frame_of_the_actuator() -> None:
    of_all = packer()
    of_all.pack(3_000_000, 2_000_000, {})
    said = {of_all.topics[k].name: data for k, data in of_all.all_messages()}
    for name, pressure in (('knee', 7e6), ('toe', 9e6)):
        message = decode(said[f'/{name}/cushion_pressure'], FluidPressure)
        assert (message.header.stamp.nanosec, message.header.frame_id) == (3_000_000, name)
        assert message.fluid_pressure == pressure + ATMOSPHERE


@pytest.mark.parametrize('heated', [(), ('knee',)])
def test_a_node_has_it_in_the_order_of_its_topics(heated: tuple[str, ...]) -> None:
    of_all = packer(*heated)
    of_all.pack(0, 0, {})
    said = {of_all.topics[k].name: data for k, data in of_all.all_messages()}
    topics = topics_of_actuator('/knee', bool(heated), False, True)
    messages = of_all.of_actuator(1)
    assert len(messages) == len(topics) and messages[-1] is not None
    for topic, message in zip(topics, messages):
        assert message is None or message == said[topic.name], topic.name
    assert len(of_all.of_actuator(0)) == len(topics) - 1 - len(heated)


def test_a_bag_of_the_press_replays_with_it(tmp_path: Path) -> None:
    """The spear of A is in from the start; the rounding is that of absolute pressures."""
    result = isa_ros.load('press', duration=0.05).simulate()
    bag = result.save(tmp_path / 'bag')
    read = isa_ros.read(bag)
    found = read['slide.cushion_pressure']
    assert np.abs(found - result['slide.cushion_pressure']).max() < 1e-8 * found.max()
    assert found.max() > 1e6 and read.units['slide.cushion_pressure'] == 'Pa'
    assert Bag(bag).types['/slide/cushion_pressure'] == TYPE
    assert_replays(bag)


@pytest.mark.parametrize(('end', 'has'), [('cushion_a', True), ('cushion_b', True), ('', False)])
def test_either_end_is_enough(end: str, has: bool) -> None:
    run = isa_ros.load('press')
    none = {f'actuators.slide.parameters.plant.{name}': {'kind': 'none'}
            for name in ('cushion_a', 'cushion_b') if name != end}
    plant = run.replace(none).configuration.actuators[0].sheet.plant
    assert is_cushioned(plant) is has
    assert not is_cushioned(isa_ros.load('winch').configuration.actuators[0].sheet.plant)
