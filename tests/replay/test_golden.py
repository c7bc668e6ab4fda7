"""The golden bags replay: the leg's touch-down and the rotary rig's torque step."""

from pathlib import Path

from isa_ros.bag.reader import Bag
import pytest

pytest_plugins = ['isa_ros.testing']
HERE = Path(__file__).parent


@pytest.mark.golden
@pytest.mark.parametrize(('name', 'tolerances'), [
    ('leg_touchdown', 'leg_tolerances.yaml'), ('rotor_step', 'rotor_tolerances.yaml')])
def test_golden_bag_replays(assert_replays, name, tolerances):
    """A changed golden bag without a changed equation is a bug."""
    assert_replays(HERE / name, HERE / tolerances)


def test_the_leg_touches_down_in_its_golden_bag():
    """The bag holds what it is there for: a sample at t = 0 and one per tick, 80 of them."""
    bag = Bag(HERE / 'leg_touchdown')
    assert (bag.start_ns, bag.end_ns, bag.is_whole) == (0, 80_000_000, True)
    assert '/coordinator/ground_contact' in bag.types
