"""Actuators started separately for a coordinator: `isa actuators`."""

import os
import signal

import pytest
from tests.ros.started import bringup, is_alive, RIG, started, wait_for

pytestmark = pytest.mark.ros


@pytest.mark.slow
def test_actuators_of_another_take_part_in_one_run_after_the_other(domain, tmp_path):
    """A signal then ends the actuators."""
    with started(tmp_path / 'actuators.log', 'isa_ros', 'actuators', str(RIG)) as actuators:
        for bag in (tmp_path / 'first', tmp_path / 'second'):
            with bringup(bag, '--duration', '0.05', '--elsewhere', 'rotor', config=RIG) as run:
                assert run.exit_code() == 0, run.errors
        children = actuators.children()
        assert list(children) == ['rotor']
        actuators.signal(signal.SIGTERM)
        assert actuators.exit_code() == 0, actuators.errors
    assert not is_alive(children['rotor'])
    assert (tmp_path / 'first' / 'first_0.mcap').read_bytes() == (
        tmp_path / 'second' / 'second_0.mcap').read_bytes()


@pytest.mark.slow
def test_both_hosts_need_the_same_values(domain, tmp_path):
    value = ('--set', 'actuators.rotor.parameters.reu.force.kp=2e-5')
    with started(tmp_path / 'actuators.log', 'isa_ros', 'actuators', str(RIG), *value):
        with bringup(tmp_path / 'same', '--duration', '0.05', '--elsewhere', 'rotor', *value,
                     config=RIG) as run:
            assert run.exit_code() == 0, run.errors
        with bringup(tmp_path / 'other', '--duration', '0.05', '--elsewhere', 'rotor',
                     config=RIG) as run:
            assert run.exit_code() == 2
        assert 'rotor' in run.errors and run.errors.count('\n') == 1


def test_a_lost_actuator_ends_its_host_naming_it(domain, tmp_path):
    with started(tmp_path / 'actuators.log', 'isa_ros', 'actuators', str(RIG)) as actuators:
        # A child gets its name shortly after its start.
        child = wait_for(lambda: actuators.children().get('rotor'), 'the child')
        os.kill(child, signal.SIGKILL)
        assert actuators.exit_code() == 3
    assert f'isa: rotor: its process {child} was ended by SIGKILL' in actuators.errors


def test_a_missing_actuator_of_another_host_is_named(domain, tmp_path):
    with bringup(tmp_path / 'bag', '--elsewhere', 'all', '--join-timeout', '0.5',
                 config=RIG) as run:
        assert run.exit_code() == 3
    assert 'rotor: no answer before tick 0 after 0.5 s' in run.errors
