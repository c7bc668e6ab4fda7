"""Two nodes with the same role: refused before a run, reported during it."""

import signal

import pytest
from tests.ros.faults import assert_replays, Fault, wait_for_tick_0
from tests.ros.hosts import two_hosts, why_no_hosts
from tests.ros.started import actuator, bringup, RIG, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
JOIN_S = 1.0  # promised: a node that has appeared is noticed within it


def test_an_actuator_started_twice_ends_the_run_naming_it(domain, tmp_path, observer):
    """The second one appears during the run and is not ended by it."""
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


def test_a_second_coordinator_of_another_host_is_refused(domain, tmp_path, monkeypatch):
    """It is detected by the graph alone; the first coordinator continues."""
    if (reason := why_no_hosts()) is not None:
        pytest.skip(f'no network namespaces: {reason}')
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    bags = tmp_path / 'first', tmp_path / 'second'
    with two_hosts() as (host, other):
        with bringup(bags[0], '--in-process', '--real-time-factor', '1', config=RIG,
                     prefix=host.enter) as first:
            wait_for_tick_0(bags[0], first)
            with bringup(bags[1], '--in-process', '--duration', '5', config=RIG,
                         prefix=other.enter) as second:
                assert second.exit_code() == 2
            first.signal(signal.SIGTERM)
            assert first.exit_code() == 130
    assert second.errors == (
        f'isa: another coordinator runs in ROS_DOMAIN_ID {domain}, must be the only one; end it '
        'or set another ROS_DOMAIN_ID\n')
    assert not bags[1].exists()
    assert_replays(bags[0])
