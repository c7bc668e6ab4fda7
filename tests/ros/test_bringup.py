"""Runs of the leg in processes: equal bytes, and early ends."""

from pathlib import Path
import re
import signal

from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.nodes.bringup import bringup as bring_up
from isa_ros.replay.replay import replay
from isa_ros.run.options import Request
from msg_adapters.cdr_reader import decode
import pytest
from sensor_msgs.msg import FluidPressure
from tests.ros.bags import sha256
from tests.ros.faults import wait_for_tick_0
from tests.ros.started import bringup, DEADLINE_S, DROP, is_alive, LEG, RIG, started

pytestmark = pytest.mark.ros


def read_sequences(bag: Path) -> list[int]:
    """Return the ticks of a bag that must be whole."""
    read = Bag(bag)
    assert read.is_whole
    return [tick.sequence for tick in read.ticks()]


def test_processes_and_one_process_give_equal_files(domain, tmp_path):
    bags = [tmp_path / 'several' / 'bag', tmp_path / 'one' / 'bag']
    for bag, options in zip(bags, [(), ('--in-process',)]):
        bag.parent.mkdir()
        with bringup(bag, '--scenario', str(DROP), '--duration', '0.3', *options) as run:
            assert run.exit_code() == 0, run.errors
    assert read_sequences(bags[0]) == list(range(301))
    assert sha256(bags[0]) == sha256(bags[1])


TWO_SUPPLIES = """
supplies:
  pump: {kind: constant, pressure_mpa: 16.0, return_pressure_mpa: 0.0, feeds: [kfe, haa]}
  hip:
    kind: constant
    pressure_mpa: 20.7
    return_pressure_mpa: 0.5
    return_line: {kind: volume, oil_volume_l: 2.0, bulk_modulus: 1.0e+9, tank_lpm_per_mpa: 40.0}
    feeds: [hfe]
"""


@pytest.mark.slow
def test_several_supplies_give_equal_files_and_replay(domain, tmp_path):
    """Each actuator is told the pressures of its own supply, wherever it runs."""
    config = tmp_path / 'leg.yaml'
    config.write_text(re.sub(r'\nsupply: .*\n', TWO_SUPPLIES, LEG.read_text()))
    bags = [tmp_path / 'several' / 'bag', tmp_path / 'one' / 'bag']
    for bag, options in zip(bags, [(), ('--in-process',)]):
        bag.parent.mkdir()
        with bringup(bag, '--scenario', str(DROP), '--duration', '0.15', *options,
                     config=config) as run:
            assert run.exit_code() == 0, run.errors
    assert sha256(bags[0]) == sha256(bags[1])
    assert replay(Bag(bags[0])).is_equal
    topic = '/coordinator/hip_return_pressure'
    pressures = [decode(message.data, FluidPressure).fluid_pressure
                 for message in Bag(bags[0]).messages() if message.topic == topic]
    assert pressures[0] == 0.5e6 + 101325.0 and len(pressures) == 151
    assert max(pressures) > pressures[0] + 100.0


def test_a_program_runs_one_after_the_other(domain, tmp_path):
    """Fast DDS was used by the first, so the processes of the second cannot be forked."""
    for name in ('first', 'second'):
        bag = bring_up(Request(
            config=RIG, out=tmp_path / name / 'bag', duration_s=0.01, join_timeout_s=DEADLINE_S))
        assert read_sequences(bag) == list(range(11))


@pytest.mark.parametrize('options', [(), ('--in-process',)])
def test_the_collector_is_spared_what_is_loaded(domain, tmp_path, options):
    """A full collection of it would halt a run for 60 ms; numba and rclpy make 100000 objects."""
    with started(tmp_path / 'log', 'tests.ros.frozen', 'bringup', str(RIG), '--duration', '0.01',
                 '--out', str(tmp_path / 'bag'), *options) as run:
        assert run.exit_code() == 0, run.errors
    frozen = re.search(r'(\d+) objects frozen', run.errors)
    assert frozen is not None and int(frozen[1]) > 50_000


@pytest.mark.parametrize(
    ('number', 'options'), [(signal.SIGTERM, ()), (signal.SIGINT, ('--in-process',))])
def test_signal_ends_cleanly(domain, tmp_path, number, options):
    bag = tmp_path / 'bag'
    with bringup(bag, *options) as run:
        wait_for_tick_0(bag, run)
        children = run.children()
        run.signal(number)
        assert run.exit_code() == 130
    assert 'stopped at t = ' in run.errors
    assert 'Traceback' not in run.errors
    assert not any(is_alive(pid) for pid in children.values())
    sequences = read_sequences(bag)
    assert sequences == list(range(len(sequences)))


def test_existing_output_is_refused_before_anything_starts(domain, tmp_path):
    bag = tmp_path / 'bag'
    bag.mkdir()
    (bag / 'notes.txt').write_text('mine')
    for options in (), ('--overwrite',):
        with bringup(bag, *options) as run:
            assert run.exit_code() == 2
        assert 'exists and is not a bag' in run.errors
    assert [path.name for path in bag.iterdir()] == ['notes.txt']


def test_other_values_reach_every_process(domain, tmp_path):
    """Values of the configuration and of the scenario: actuators compare the digests of both."""
    values = ('--set', 'actuators.rotor.parameters.reu.force.kp=2e-5',
              '--set', 'scenario.loads.rotor.stiffness=2e4')
    bags = [tmp_path / 'several' / 'bag', tmp_path / 'one' / 'bag']
    for bag, options in zip(bags, [(), ('--in-process',)]):
        bag.parent.mkdir()
        with bringup(bag, '--scenario', 'torque_bandwidth', '--duration', '0.05', *values,
                     *options, config=RIG) as run:
            assert run.exit_code() == 0, run.errors
    assert sha256(bags[0]) == sha256(bags[1])
    rotor, = run_of_text(Bag(bags[0]).provenance.configuration).actuators
    assert (rotor.sheet.reu.force.kp, rotor.load.stiffness) == (2e-5, 2e4)
