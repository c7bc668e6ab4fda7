"""What there must be once is there twice: refused before a run, named during it."""

import pytest
from tests.ros.faults import assert_replays, Fault, wait_for_tick_0
from tests.ros.started import actuator, bringup, RIG, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
JOIN_S = 1.0  # promised: a node that has appeared is noticed within it


def test_an_actuator_started_twice_ends_the_run_naming_it(domain, tmp_path, observer):
    """The second one appears during the run; it is nobody's to end."""
    bag = tmp_path / 'bag'
    with bringup(bag, config=RIG) as run:
        wait_for_tick_0(bag, run)
        wait_for(lambda: observer.count_publishers('/rotor/joint_states') == 1, 'the first')
        fault = Fault(run, bag)
        with actuator(tmp_path / 'second.log', 'rotor', config_file=RIG, lockstep=True) as second:
            wait_for(lambda: observer.count_publishers('/rotor/joint_states') != 1, 'the second')
            fault.begin()
            ended = fault.ended(JOIN_S)
            assert second.is_running()
    assert ended.exit_code == 2
    assert ended.line == (
        f'isa: rotor: two nodes of this name answer in ROS_DOMAIN_ID {domain}, must be one')
    assert_replays(bag)
