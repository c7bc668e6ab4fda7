"""Several runs in one domain, one in each namespace: none disturbs another."""

import signal

import pytest
from tests.ros.bags import mcap_file
from tests.ros.faults import assert_replays, wait_for_tick_0, WHEEL_SINE
from tests.ros.started import bringup, RIG, started, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
BEHIND = 's of host time behind real_time_factor = 1 at the end'     # of a busy host


def test_runs_of_other_namespaces_go_on_while_others_begin_and_end(
        observer, tmp_path, patient_rig, undisturbed):
    """
    One lasts; beside it one after the other begins and ends, in processes and in one process.

    The bags of those that end have the bytes of the run that was alone in its domain.
    """
    lasting, after = tmp_path / 'lasting', tmp_path / 'after'
    with bringup(lasting, '--namespace', 'left', '--real-time-factor', '1', config=RIG) as left:
        wait_for_tick_0(lasting, left)
        for namespace, how in ((), ()), (('--namespace', 'arm/right'), ('--in-process',)):
            bag = tmp_path / '_'.join(('beside', *namespace[1:])).replace('/', '_')
            with bringup(bag, *namespace, *how, *WHEEL_SINE, config=patient_rig) as run:
                assert run.exit_code() == 0, run.errors
            assert mcap_file(bag).read_bytes() == mcap_file(undisturbed).read_bytes()
        with bringup(after, '--real-time-factor', '1', config=RIG) as root:
            wait_for_tick_0(after, root)
            topics = wait_for(lambda: both_of(dict(observer.get_topic_names_and_types())))
            left.signal(signal.SIGTERM)
            assert left.exit_code() == 130 and root.is_running(), left.errors + root.errors
            root.signal(signal.SIGTERM)
            assert root.exit_code() == 130, root.errors
    assert [line for run in (left, root) for line in run.errors.splitlines()
            if 'stopped at t = ' not in line and BEHIND not in line] == []
    assert {topic for topic in topics if topic.startswith('/_isa')} == {
        '/_isa/step', '/_isa/acknowledgement'}
    assert assert_replays(lasting) > 0 and assert_replays(after) > 0


def both_of(topics: dict[str, list[str]]) -> dict[str, list[str]]:
    """Return the topics once those of both runs are there; each has its time and its wire."""
    needed = [f'{namespace}/{name}' for namespace in ('', '/left') for name in (
        'clock', 'diagnostics', 'rotor/joint_states', 'coordinator/events', '_isa/step')]
    return topics if all(name in topics for name in needed) else {}


def test_actuators_started_elsewhere_take_part_in_the_run_of_their_namespace(domain, tmp_path):
    """A coordinator of another namespace does not find them."""
    bag = tmp_path / 'bag'
    elsewhere = '--elsewhere', 'all', '--duration', '0.05'
    with started(tmp_path / 'host.log', 'isa_ros', 'actuators', str(RIG), '--namespace', 'left'):
        with bringup(bag, *elsewhere, '--namespace', '/left', config=RIG) as run:
            assert run.exit_code() == 0, run.errors
        with bringup(tmp_path / 'none', *elsewhere, '--join-timeout', '0.5', config=RIG) as run:
            assert run.exit_code() == 3
    assert run.errors == (
        'isa: rotor: no answer before tick 0 after 0.5 s; start it with lockstep:=true in this '
        'ROS_DOMAIN_ID and namespace, /\n')
    assert assert_replays(bag) == 50
