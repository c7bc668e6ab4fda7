"""Two nodes with the same role: refused before a run, reported or refused during it."""

import os
import signal

from isa_ros.nodes.middleware.domain import CLAIMED_BY, sole_coordinator
import pytest
from tests.ros.faults import assert_replays, wait_for_tick_0
from tests.ros.hosts import two_hosts, why_no_hosts
from tests.ros.started import actuator, bringup, coordinator, RIG, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def test_an_actuator_started_twice_is_reported_and_the_run_goes_on(domain, tmp_path, monkeypatch):
    """The second one appears during the run, which a launch has claimed; it takes no part."""
    monkeypatch.setenv(CLAIMED_BY, str(os.getpid()))
    bag, rotor = tmp_path / 'bag', {'config_file': RIG, 'lockstep': True}
    with sole_coordinator(), actuator(tmp_path / 'first.log', 'rotor', **rotor), coordinator(
            tmp_path / 'coordinator.log', config_file=RIG, out=bag) as run:
        wait_for_tick_0(bag, run)
        with actuator(tmp_path / 'second.log', 'rotor', **rotor) as second:
            wait_for(lambda: 'second node' in run.errors or not run.is_running(), 'the warning')
            assert run.is_running() and second.is_running()
        run.signal(signal.SIGTERM)
        assert run.exit_code() == 130, run.errors
    warned, = (line for line in run.errors.splitlines() if 'second node' in line)
    assert warned.endswith(
        f'rotor: a second node of this name waits in ROS_DOMAIN_ID {domain}, namespace /; the '
        'run goes on with the first')
    assert assert_replays(bag) > 0


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
        f'isa: another coordinator runs in ROS_DOMAIN_ID {domain}, namespace /, must be the only '
        'one; end it, or use another namespace or ROS_DOMAIN_ID\n')
    assert not bags[1].exists()
    assert_replays(bags[0])
