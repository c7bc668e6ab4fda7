"""
Rows of "Places for extensions" whose extension changes the kernels, all in one copy.

The kernels of a copy compile for half a minute, so they compile once; and each extension has to
run beside the others.
"""

from pathlib import Path
import re
from typing import NamedTuple

from isa_ros.core.conditions import CONDITIONS
import pytest
from tests.docs.kernel_patches import (
    add_block, add_condition, add_load, add_part, add_sensor, add_wire)
from tests.docs.patched_copy import files_of, names_of, PatchedCopy

_TRIPS = """
import isa_ros
from isa_ros.fieldbus.device.devices import devices_of
import isa_ros.fieldbus.lines
run = isa_ros.load('rig_linear').replace({
    'actuators.ram.parameters.reu.protection.undervoltage.trip': 0.99})
simulation = run.simulation()
for _ in range(2):
    sample = simulation.step()['ram']
print(isa_ros.conditions(sample['trips']))
device, = devices_of(run.configuration)
device.take_sample(sample, 0)
print(*(f'{one.code:04X} {one.register:02X}' for one in device.emergencies()))
"""
_SENSES = """
import isa_ros
run = isa_ros.load('rig_linear', duration=0.05).replace({
    'actuators.ram.parameters.plant.sensors.tachometer.bias': 1.0})
result = run.simulate()
difference = result['ram.tachometer'][1:] - result['ram.velocity'][1:]
print(result.units['ram.tachometer'], abs(difference - 1.0).max() < 0.1)
"""
_BRAKES = """
import isa_ros
slow, free = (isa_ros.load('rig_linear', {'name': 'push', 'duration_s': 1.0, 'tracks': {
    'ram': [{'t_s': 0.0, 'position': 0.04, 'effort': 2000.0, 'stiffness': 0.0, 'damping': 0.0}]}}
    ).replace({'actuators.ram.load': {'kind': 'braked', 'drag': drag}}).simulate(0.1)
    for drag in (1e6, 0.0))
speeds = [float(abs(own['ram.velocity']).max()) for own in (slow, free)]
print(speeds[0] < 0.5 * speeds[1], speeds)
"""
_HITS = """
import isa_ros
hard, soft = (isa_ros.load('rig_linear', {'name': 'out', 'duration_s': 0.4, 'tracks': {'ram': [
    {'t_s': 0.0, 'position': 0.05, 'effort': 2000.0, 'stiffness': 0.0, 'damping': 0.0}]}}
    ).replace({'actuators.ram.parameters.plant.buffer': {'length': 0.01, 'damping': damping}}
              ).simulate() for damping in (0.0, 2e4))
arrivals = [float(own['ram.velocity'][own['ram.position'] > 0.0998][0]) for own in (hard, soft)]
account = soft.accounts['ram']
used = sum(account[name] for name in account if name.endswith('(J)')) - (
    account['hydraulic energy (J)'])
print(arrivals[0] > 0.8, arrivals[1] < 0.3, abs(used / account['hydraulic energy (J)'] - 1) < 1e-3)
"""
_PUSHES = """
import isa_ros
run = isa_ros.load('rig_linear', {'name': 'push', 'duration_s': 0.2, 'tracks': {'ram': [
    {'t_s': 0.0, 'effort': 1000.0, 'position': 0.05, 'stiffness': 0.0, 'damping': 0.0}]}}
    ).replace({'actuators.ram.variants': ['proportional'],
               'actuators.ram.load': {'kind': 'blocked'}})
weak, strong = (run.replace({'actuators.ram.parameters.reu.force.kp': kp}).simulate()
                for kp in (1e-9, 1e-8))
forces = [own['ram.force'][-1] for own in (weak, strong)]
spools = [own['ram.spool_reference'][-1] for own in (weak, strong)]
print(400.0 < forces[0] < 700.0 < 900.0 < forces[1] < 1000.0,
      [f'{spool / (1000.0 - force):.0e}' for spool, force in zip(spools, forces)])
simulation = run.simulation()
for _ in range(50):
    simulation.step()
simulation.tune('ram', {'force.kp': 0.0})
for _ in range(2):
    simulation.step()
print(simulation.samples['ram']['spool_reference'])
"""
_CYCLES = """
import isa_ros
run = isa_ros.load('rig_linear').replace({'link': {'kind': 'canfd', 'cycle_ms': 1.0}})
print(run.simulate(0.002)['ram.link.age'].shape)
"""
_STARTS = """
import sys
from pathlib import Path
from isa_ros.core import kernel_library
kernel_library.SHIPPED = Path('/none/such')
from numba.core.event import install_recorder
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.run.warm_up import warmed_up
import isa_ros
with install_recorder('numba:compile') as compiled:
    warmed_up(load_run(shipped(CONFIG)['rig_linear.yaml']))
from isa_ros.actuator.ticking import tick_kernel
from isa_ros.plant.servo_valve import flow_curve
print(isa_ros.__file__, [event.data['dispatcher'].__name__ for _, event in compiled.buffer],
      bool(flow_curve.stats.cache_hits), tick_kernel().is_kept())
print([name for name in ('numba.np.arraymath', 'scipy.linalg') if name in sys.modules])
"""
_NO_PROCESS = """
from isa_ros.core import bitcode
bitcode._PROGRAM = 'raise SystemExit(9)'
"""
_STAYS = """
from hashlib import sha256
import isa_ros
result = isa_ros.load('rig_linear', 'identify_linear').simulate(0.3)
print(sha256(b''.join(result[f'ram.{name}'].tobytes() for name in (
    'position', 'velocity', 'force', 'pressure_a', 'pressure_b', 'spool', 'current'))).hexdigest())
"""


class Extended(NamedTuple):
    """A copy with all extensions, and the files that each touches."""

    copied: PatchedCopy
    condition: list[str]
    sensor: list[str]
    load: list[str]
    part: list[str]
    block: list[str]
    wire: list[str]


@pytest.fixture(scope='module')
def extended(tmp_path_factory: pytest.TempPathFactory) -> Extended:
    """Return a copy of the package with all extensions."""
    copied = PatchedCopy(tmp_path_factory.mktemp('extended'))
    return Extended(copied, *(copied.touched_by(each) for each in (
        add_condition, add_sensor, add_load, add_part, add_block, add_wire)))


@pytest.mark.slow
def test_a_condition_is_a_row_and_a_line(extended: Extended) -> None:
    """Sheet, bit, words, error on a bus and pages are made from the row."""
    copied = extended.copied
    assert len(extended.condition) == 2
    parameters = copied.isa('params', 'isa_v5')
    assert 'reu.protection.undervoltage.reaction ' in parameters
    assert copied.python(_TRIPS) == "['undervoltage']\nFF10 81\n"
    assert '0x2024 ' in copied.isa('bus', 'describe', 'rig_linear', '--table')
    copied.script('scripts/write_protection.py')
    assert (f'\n| {len(CONDITIONS)} | `undervoltage` | supply pressure |'
            in copied.read('docs/protection.md'))
    copied.script('scripts/write_objects.py')
    assert '\n| `undervoltage` | 0xFF10 | 0x81 |' in copied.read('docs/objects.md')


@pytest.mark.slow
def test_a_sensor_is_a_channel_and_a_row_of_the_sample(extended: Extended) -> None:
    """Its errors, noise, parameters and faults; result, units and pages."""
    copied = extended.copied
    assert len(extended.sensor) == 4
    assert copied.python(_SENSES) == 'm/s True\n'
    parameters = copied.isa('params', 'isa_v5')
    assert 'plant.sensors.tachometer.stuck ' in parameters
    copied.script('scripts/write_signals.py')
    assert '\n| `tachometer` | m/s or rad/s | as sensed |' in copied.read('docs/signals.md')


@pytest.mark.slow
def test_a_load_is_a_set_a_force_and_values(extended: Extended) -> None:
    """It brakes: -c v abs(v)."""
    copied = extended.copied
    assert names_of(extended.load) == files_of('load of one actuator') - {'docs/equations.md'}
    assert len(extended.load) == 3
    assert copied.python(_BRAKES).startswith('True ')
    assert 'load braked' in copied.isa('params', 'isa_v5')


@pytest.mark.slow
def test_a_part_of_the_plant_is_a_file_and_its_term(extended: Extended) -> None:
    """Buffers: they lessen the impact at the ends; the energy account closes over it."""
    copied = extended.copied
    assert len(extended.part) == 3
    assert copied.python(_HITS) == 'True True True\n'
    assert 'plant.buffer.damping ' in copied.isa('params', 'isa_v5')


@pytest.mark.slow
def test_a_control_block_is_a_file_a_kind_and_a_branch(extended: Extended) -> None:
    """It controls, it can be tuned, and its variant is listed."""
    copied = extended.copied
    assert len(extended.block) == 4
    assert copied.python(_PUSHES) == "True ['1e-09', '1e-08']\n0.0\n"
    assert 'reu.force.kp ' in copied.isa('params', 'isa_v5', '--variant', 'proportional')


@pytest.mark.slow
def test_a_wire_is_its_values_and_a_name(extended: Extended) -> None:
    """Links may have its kind, and its load is checked."""
    copied = extended.copied
    assert names_of(extended.wire) == files_of('wire of a link') and len(extended.wire) == 2
    listed = copied.isa('params', 'rig_linear', '--set', 'link.kind=canfd', '--set',
                        'link.cycle_ms=0.2')
    assert re.search(r'^wire of links: canfd\nparameter.*\nbit_rate_mbit +5 ', listed, re.M)
    assert copied.python(_CYCLES) == '(3,)\n'


@pytest.mark.slow
def test_what_is_compiled_there_gives_the_same_bytes(
        extended: Extended, capsys: pytest.CaptureFixture[str]) -> None:
    """A run without the extensions: its tick is compiled in the copy, and in a library here."""
    exec(_STAYS, {})
    assert extended.copied.python(_STAYS) == capsys.readouterr().out


@pytest.mark.slow
def test_the_same_with_other_words_compiles_nothing(extended: Extended, tmp_path: Path) -> None:
    """
    Nor does a second start: a version of numba that cannot load what it kept shows here.

    What only a compiler needs is not loaded either: half of the processor time of a start. There
    are no libraries, and the process that lowers the tick cannot be started again; where numba has
    kept the tick, as of an older revision, its code is taken.
    """
    extended.copied.python(_STARTS)
    other = extended.copied.reworded(tmp_path)
    assert other.python(_NO_PROCESS + _STARTS) == (
        f'{other.root}/isa_ros/__init__.py [] True True\n[]\n')
