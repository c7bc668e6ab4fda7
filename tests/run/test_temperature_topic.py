"""The topic of the oil's temperature: which actuators have it, and when it has a message."""

from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.run.packing import Packer
from isa_ros.run.row_messages import Names, topics_of_actuator
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.testing import assert_replays
from isa_ros.tick.exchange import PublishedRows
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import Temperature

TOPIC = '/knee/temperature'
TYPE = 'sensor_msgs/msg/Temperature'
SECOND = 10**9


@pytest.fixture
def packer() -> Packer:
    """Return the packer of two actuators, of which the knee is heated to 47 celsius."""
    samples = np.zeros(2, SAMPLE)
    samples['temperature'] = 40.0, 47.0
    rows = PublishedRows(samples, np.zeros(2, COMMAND), np.zeros(1, SUPPLY_SAMPLE), {})
    return Packer(
        Names([('hip', True), ('knee', False)], [('supply', ['pressure'])], heated=['knee']), rows)


def messages(packer: Packer) -> dict[str, bytes]:
    return {packer.topics[k].name: data for k, data in packer.all_messages()}


def test_only_a_heated_actuator_has_the_topic(packer: Packer) -> None:
    found = {topic.name: topic for topic in packer.topics if 'temperature' in topic.name}
    assert list(found) == [TOPIC]
    assert found[TOPIC].type_name == TYPE and not found[TOPIC].qos.is_kept
    assert TOPIC not in [topic.name for topic in packer.surroundings]
    assert [topic.name for topic in topics_of_actuator('~', False)] == [
        topic.name for topic in topics_of_actuator('~', True)][:-1]


def test_the_message_is_celsius_in_the_frame_of_the_actuator(packer: Packer) -> None:
    """A variance of 0 means that it is unknown (sensor_msgs/Temperature)."""
    packer.pack(3 * SECOND, 3 * SECOND - 1_000_000, {})
    message = decode(messages(packer)[TOPIC], Temperature)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (3, 0)
    assert message.header.frame_id == 'knee'
    assert (message.temperature, message.variance) == (47.0, 0.0)


@pytest.mark.parametrize(('t_ns', 'start_ns', 'is_due'), [
    (0, 0, True), (1_000_000, 0, False), (SECOND - 1, SECOND - 2, False),
    (SECOND, SECOND - 1, True), (SECOND + 1, SECOND, False),
    (SECOND + 30, SECOND - 40, True)])
def test_it_comes_at_0_and_with_every_full_second(
        packer: Packer, t_ns: int, start_ns: int, is_due: bool) -> None:
    """A tick that does not divide a second reaches it in the middle; others are as before."""
    packer.pack(t_ns, start_ns, {})
    all_of_it = messages(packer)
    assert (TOPIC in all_of_it) is is_due
    assert '/knee/valve' in all_of_it and '/hip/valve' in all_of_it
    assert packer.of_actuator(1)[-1] == all_of_it.get(TOPIC)
    assert len(packer.of_actuator(0)) == len(packer.of_actuator(1)) - 1


def test_a_bag_replays_with_its_temperatures(tmp_path: Path) -> None:
    bag = isa_ros.load('rig_temperature', 'temperature', duration=1.2).simulate().save(
        tmp_path / 'bag')
    stamps = [message.t_ns for message in Bag(bag).messages()
              if message.topic == '/leak/temperature']
    assert stamps == [0, SECOND]
    assert_replays(bag)
