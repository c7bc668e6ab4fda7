"""Faults of the device on nodes: the bytes of one process, and values set while a run goes on."""

from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.replay.replay import recorded_inputs, replay
from isa_ros.scripting.run import load
import pytest
from tests.ros.bags import sha256
from tests.ros.started import bringup, RIG, rig_until_stopped
from tests.ros.tuner import Tuner

pytestmark = [pytest.mark.ros, pytest.mark.slow]
FAULTS = find('device_faults.yaml', SCENARIOS)
SECONDS = 0.4


def test_a_scenario_of_faults_gives_one_sha256_in_memory_in_one_process_and_in_many(
        domain, tmp_path):
    """The changes reach the actuators' processes before the tick of their time."""
    run = load(find('leg.yaml', CONFIG), FAULTS, duration=SECONDS)
    found = [sha256(run.simulate().save(tmp_path / 'in_memory' / 'bag'))]
    for name, options in (('one', ('--in-process',)), ('many', ())):
        bag = tmp_path / name / 'bag'
        bag.parent.mkdir()
        with bringup(bag, '--scenario', str(FAULTS), '--duration', str(SECONDS),
                     '--join-timeout', '100', *options) as process:
            assert process.exit_code() == 0, process.errors
        found.append(sha256(bag))
    assert len(set(found)) == 1, found


@pytest.mark.parametrize('options', [(), ('--in-process',)])
def test_what_is_set_in_a_run_is_recorded_with_its_tick_and_replays(
        observer, tmp_path, options):
    """Of an actuator by its node, of a supply by the coordinator's; refusals say why."""
    bag = tmp_path / 'bag'
    with rig_until_stopped(bag, *options):
        rotor = Tuner(observer, 'rotor')
        rotor.connect()
        assert rotor.tune('plant.spool.stuck', 1.0).successful
        refused = rotor.tune('plant.spool.stuck', 0.5)
        assert not refused.successful and 'must be a whole number' in refused.reason
        rotor.let_run()
        assert rotor.get('plant.spool.stuck') == [1.0]
        supplies = Tuner(observer, 'coordinator')  # from here on it spins the observer
        supplies.wait_for(lambda: all(
            own.service_is_ready() for own in supplies._clients.values()), 'its services')
        assert supplies.tune('supply.pressure_mpa', 12.0).successful
        assert supplies.get('supply.pressure_mpa') == [12.0]
        supplies.wait_for(lambda: supplies.events, 'what took effect')
    run = load(RIG).configuration
    inputs = recorded_inputs(Bag(bag), run)
    assert [list(inputs.tuned['rotor'].values()), list(inputs.tuned_supplies.values())] == [
        [{'plant.spool.stuck': 1.0}], [{'supply.pressure_mpa': 12.0}]]
    assert replay(Bag(bag)).is_equal
