"""The coordinator executable, which waits for participants started separately."""

import signal

from isa_ros.run.wire.answers import ACKNOWLEDGEMENT_TOPIC
import pytest
from tests.ros.started import actuator, bringup, coordinator, LEG, RIG, started, wait_for

pytestmark = pytest.mark.ros


@pytest.mark.parametrize('module', ['actuator', 'coordinator'])
def test_a_profile_that_is_not_there_is_one_line(domain, tmp_path, monkeypatch, module):
    profile = tmp_path / 'typo.xml'
    monkeypatch.setenv('FASTRTPS_DEFAULT_PROFILES_FILE', str(profile))
    with started(tmp_path / 'log', f'isa_ros.programs.{module}') as node:
        assert node.exit_code() == 2
    who, _, line = node.errors.partition(': ')
    assert line == f'FASTRTPS_DEFAULT_PROFILES_FILE = {profile}: no such file\n', who


def test_missing_participant_is_named(domain, tmp_path):
    bag = tmp_path / 'bag'
    with coordinator(tmp_path / 'coordinator.log', config_file=RIG, out=bag,
                     join_timeout_s=0.5) as run:
        assert run.exit_code() == 3
    assert 'rotor: no answer before tick 0 after 0.5 s' in run.errors
    assert not bag.exists()


def test_ticks_too_long_for_the_ground_are_reported_before_the_wait(domain, tmp_path):
    config = tmp_path / 'leg.yaml'
    config.write_text(LEG.read_text().replace(
        '  model: hyq_real', '  model: hyq_real\n  ground: metal'))
    with coordinator(tmp_path / 'coordinator.log', config_file=config, out=tmp_path / 'bag',
                     join_timeout_s=0.1) as run:
        assert run.exit_code() == 3
    lines = run.errors.splitlines()
    warned, = (k for k, line in enumerate(lines) if 'an impact lasts 1.8 ms' in line)
    assert 'no answer before tick 0' in lines[-1] and warned < len(lines) - 1


@pytest.mark.slow
def test_participants_may_be_started_by_hand_and_used_again(domain, tmp_path):
    """After one run a participant begins the next at t = 0: both bags are equal."""
    bags = [tmp_path / name / 'bag' for name in ('first', 'second')]
    with actuator(tmp_path / 'rotor.log', 'rotor', config_file=RIG, lockstep=True) as rotor:
        for bag in bags:
            with coordinator(bag.parent.with_suffix('.log'), config_file=RIG, out=bag,
                             duration=0.05) as run:
                assert run.exit_code() == 0, run.errors
        assert rotor.is_running()
        rotor.signal(signal.SIGTERM)
        assert rotor.exit_code() == 0
    first, second = ((bag / 'bag_0.mcap').read_bytes() for bag in bags)
    assert first == second


def test_other_parameters_are_refused(domain, tmp_path):
    other = tmp_path / 'other.yaml'
    other.write_text(RIG.read_text().replace('preset: table_4', 'preset: default'))
    with actuator(tmp_path / 'rotor.log', 'rotor', config_file=other, lockstep=True):
        with coordinator(tmp_path / 'coordinator.log', config_file=RIG,
                         out=tmp_path / 'bag') as run:
            assert run.exit_code() == 2
    assert 'rotor: digest of its parameters' in run.errors
    assert not (tmp_path / 'bag').exists()


@pytest.mark.slow
@pytest.mark.parametrize('in_process', [False, True])
def test_second_coordinator_is_refused_and_the_first_goes_on(domain, tmp_path, in_process):
    first_bag = tmp_path / 'first'
    with bringup(first_bag, '--real-time-factor', '1', config=RIG) as first:
        wait_for(lambda: (first_bag / 'metadata.yaml').exists(), 'tick 0')
        with coordinator(tmp_path / 'second.log', config_file=RIG,
                         out=tmp_path / 'second', in_process=in_process) as second:
            assert second.exit_code() == 2
        assert f'another coordinator runs in ROS_DOMAIN_ID {domain}' in second.errors
        assert not (tmp_path / 'second').exists()
        assert first.is_running()
        first.signal(signal.SIGTERM)
        assert first.exit_code() == 130


@pytest.mark.slow
def test_two_nodes_of_one_name_are_refused(domain, tmp_path, observer):
    """
    The coordinator cannot decide which of the two is the actuator.

    The run goes on with the first if the second answers after the last hello (a busy host).
    """
    arguments = {'config_file': RIG, 'lockstep': True}
    with actuator(tmp_path / 'a.log', 'rotor', **arguments) as a, \
            actuator(tmp_path / 'b.log', 'rotor', **arguments) as b:
        def are_there() -> bool:
            assert a.is_running() and b.is_running(), a.errors + b.errors
            return observer.count_publishers(ACKNOWLEDGEMENT_TOPIC) == 2
        wait_for(are_there, 'both')
        with coordinator(tmp_path / 'c.log', config_file=RIG, out=tmp_path / 'bag') as run:
            late = 'rotor: a second node of this name waits in'
            wait_for(lambda: late in run.errors or not run.is_running(), 'refused or reported')
            if late not in run.errors:
                assert run.exit_code() == 2
                assert 'rotor: two nodes of this name answer in' in run.errors
