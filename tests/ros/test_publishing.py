"""Topics that are published at fewer ticks than the bag has, on running nodes."""

from typing import Any

from isa_ros.bag.reader import Bag
from isa_ros.replay.replay import replay
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from tests.ros.spinning import Spinning
from tests.ros.started import bringup, RIG

pytestmark = [pytest.mark.ros, pytest.mark.slow]
TICKS = 400
N_LATER = 100   # messages that were received and not handled yet
SECTION = 'publish: {decimate: {/clock: 7, /rotor/references: 5}}\n'


@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_the_topics_of_patterns_come_at_their_ticks_and_the_bag_has_all(
        observer, tmp_path, options):
    config = tmp_path / 'rig.yaml'
    config.write_text(RIG.read_text() + SECTION)
    ticks: dict[str, list[int]] = {name: [] for name in ('references', 'joint_states', 'clock')}

    def heard(name: str) -> Any:
        def on_message(message: Any) -> None:
            stamp = message.clock if name == 'clock' else message.header.stamp
            ticks[name].append((stamp.sec * 10**9 + stamp.nanosec) // 1_000_000)
        return on_message
    observer.create_subscription(Clock, '/clock', heard('clock'), 1000)
    for name in ('references', 'joint_states'):
        observer.create_subscription(JointState, f'/rotor/{name}', heard(name), 1000)
    spinning = Spinning(observer)
    with bringup(tmp_path / 'bag', '--duration', str(TICKS * 1e-3), '--real-time-factor', '0.2',
                 *options, config=config) as run:
        spinning.wait_for(lambda: not run.is_running(), 'the end of the run')
        assert run.exit_code() == 0, run.errors
    for _ in range(N_LATER):
        spinning.spin_once()
    for name, period in (('references', 5), ('clock', 7)):
        assert len(ticks[name]) > 10 and all(tick % period == 0 for tick in ticks[name])
    assert {tick % 5 for tick in ticks['joint_states']} == set(range(5))
    bag = Bag(tmp_path / 'bag')
    for name in ('/clock', '/rotor/references', '/rotor/joint_states'):
        assert sum(m.topic == name for m in bag.messages()) == TICKS + 1
    assert replay(bag).is_equal
