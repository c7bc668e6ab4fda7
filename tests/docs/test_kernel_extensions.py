"""
Rows of "Places for extensions" whose extension changes the kernels, all in one copy.

The kernels of a copy compile for half a minute, so they compile once; and each extension has to
run beside the others.
"""

from typing import NamedTuple

from isa_ros.core.conditions import CONDITIONS
import pytest
from tests.docs.patched_copy import files_of, names_of, PatchedCopy

_CONDITION = '''    Condition(
        'undervoltage', 'The supply sags below what the pumps need.',
        'supply pressure', 'Pa', 'opening_pressure',
        ErrorCode(0xFF10, MANUFACTURER, 'manufacturer: undervoltage'),
        LevelDefaults(
            'pressure over the opening of the relief valves', 1.0, warning=0.0, trip=0.0,
            delay_ms=0.0, reaction='disable'),
        is_above=False),
)
"""All conditions;'''
_MEASURED = '    values[BIT.spool_deviation] = spool_deviation(state, protection.evidence)\n'
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
_CHANNEL = """

@dataclass(frozen=True, kw_only=True)
class TachometerChannel(Channel):

    sigma: float = _sigma('m/s | rad/s', 1.0)
    bias: float = _bias('m/s | rad/s', 10.0)
    drift_per_s: float = _drift('m/s2 | rad/s2', 1.0)


CHANNEL_ERRORS = """
_SENSES = """
import isa_ros
run = isa_ros.load('rig_linear', duration=0.05).replace({
    'actuators.ram.parameters.plant.sensors.tachometer.bias': 1.0})
result = run.simulate()
difference = result['ram.tachometer'][1:] - result['ram.velocity'][1:]
print(result.units['ram.tachometer'], abs(difference - 1.0).max() < 0.1)
"""
_BRAKED = '''@dataclass(frozen=True, kw_only=True)
class Braked(Parameters):
    """A mass with a drag that grows with the square of its speed."""

    inertia: float = parameter('moving mass', 'kg | kg m2', gt=0.0, le=1e4)
    drag: float = parameter('force per square of the speed', 'kg | kg m2', ge=0.0, le=1e6)
    force: float = external_force()


LocalLoad = Blocked | Wheel | Mass | Pad | DropRig | Braked
'''
_BRAKES = """
import isa_ros
slow, free = (isa_ros.load('rig_linear', {'name': 'push', 'duration_s': 1.0, 'tracks': {
    'ram': [{'t_s': 0.0, 'position': 0.04, 'effort': 2000.0, 'stiffness': 0.0, 'damping': 0.0}]}}
    ).replace({'actuators.ram.load': {'kind': 'braked', 'drag': drag}}).simulate(0.1)
    for drag in (1e6, 0.0))
speeds = [float(abs(own['ram.velocity']).max()) for own in (slow, free)]
print(speeds[0] < 0.5 * speeds[1], speeds)
"""

_BUFFER = '''"""A friction buffer at each end of the stroke, which drags at what moves outwards."""

from dataclasses import dataclass

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Buffer(Parameters):
    """Two buffers."""

    length: float = parameter('at each end; 0: none', 'm | rad', ge=0.0, le=0.1)
    damping: float = parameter('force per speed', 'Ns/m | Nms/rad', ge=0.0, le=1e6)


BUFFER = np.dtype([('length', 'f8'), ('damping', 'f8')])


def buffer_record(sheet: Buffer) -> np.record:
    """Return the `BUFFER` record of a sheet."""
    return record(BUFFER, length=sheet.length, damping=sheet.damping)


@kernel
def buffer_force(s, v, stroke, buffer):
    """Return the force against a motion towards an end, N or Nm."""
    if s < buffer.length and v < 0.0 or s > stroke - buffer.length and v > 0.0:
        return -buffer.damping * v
    return 0.0
'''
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
_PROPORTIONAL = '''"""Force block without memory: its output is K_p times the error."""

from dataclasses import dataclass

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters, tunable
from isa_ros.core.record import record
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Proportional(Parameters):
    """One gain."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    kp: float = tunable('gain K_p', 'output/measured', ge=0.0, le=1e9)
    limit: float = tunable('largest output', 'output', gt=0.0, le=1e9)


PROPORTIONAL = np.dtype([('kp', 'f8'), ('limit', 'f8')])


def proportional_record(sheet: Proportional) -> np.record:
    """Return the `PROPORTIONAL` record of a sheet."""
    return record(PROPORTIONAL, kp=sheet.kp, limit=sheet.limit)


@kernel
def proportional_step(reference, measured, block, state):
    """Set the output."""
    state.output = max(-block.limit, min(block.limit, block.kp * (reference - measured)))
'''
_VARIANT = """
variants:
  proportional:
    reu:
      force:
        kind: proportional
        rate_hz: {value: 5000.0, source: assumed}
        kp: {value: 1.0e-8, source: assumed}
        limit: {value: 1.78e-4, scales_with: spool_travel, source: assumed}
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


class Extended(NamedTuple):
    """A copy with all extensions, and the files that each touches."""

    copied: PatchedCopy
    condition: list[str]
    sensor: list[str]
    load: list[str]
    part: list[str]
    block: list[str]


def _condition(copied: PatchedCopy) -> None:
    copied.replace(
        'isa_ros/core/conditions.py', ')\n"""All conditions;', _CONDITION)
    copied.replace(
        'isa_ros/reu/protection.py', _MEASURED,
        f'{_MEASURED}    values[BIT.undervoltage] = supply_pressure\n')


def _sensor(copied: PatchedCopy) -> None:
    signals, sensors = 'isa_ros/core/signals.py', 'isa_ros/plant/sensors.py'
    last = '])\n"""The last readings of the channels'
    copied.replace(signals, last, f"    ('tachometer', 'f8'),\n{last}")
    last = ')\n"""The values one actuator reports'
    copied.replace(
        signals, last, f"    Field('tachometer', 'm/s | rad/s', 'as sensed'),\n{last}")
    copied.replace('isa_ros/plant/channels.py', '\nCHANNEL_ERRORS = ', _CHANNEL)
    last = '    temperature: TemperatureSensor ='
    copied.replace(
        sensors, last, '    tachometer: channels.TachometerChannel = section('
        f'channels.TachometerChannel)\n{last}')
    for old, new in (
            ('    if not own.errors.are_ideal:\n        supply_pressure = disturb(',
             'measured.tachometer = at.velocity'),
            ('    channels.disturb(', 'exact[6] = measured.tachometer'),
            ('    return shown[', 'measured.tachometer = shown[6]')):
        copied.replace(sensors, old, f'    {new}\n{old}')
    copied.replace(
        'isa_ros/actuator/kernel.py', '    sample.current = measured.current\n',
        '    sample.current = measured.current\n    sample.tachometer = measured.tachometer\n')


def _load(copied: PatchedCopy) -> None:
    sheets, forces = 'isa_ros/loads/sheets.py', 'isa_ros/loads/forces.py'
    copied.replace(sheets, 'LocalLoad = Blocked | Wheel | Mass | Pad | DropRig\n', _BRAKED)
    copied.replace(sheets, '    elif isinstance(load, Pad):\n',
                   "    elif isinstance(load, Braked):\n        own['drag'] = load.drag\n"
                   '    elif isinstance(load, Pad):\n')
    copied.replace(forces, "('rope', ROPE)])", "('rope', ROPE), ('drag', 'f8')])")
    copied.replace(forces, '    if own.rope.stiffness > 0.0:\n',
                   '    force -= own.drag * y.velocity * abs(y.velocity)\n'
                   '    if own.rope.stiffness > 0.0:\n')
    model = 'isa_ros/config/data/models/isa_v5.yaml'
    copied.replace(model, '\nloads:\n', '\nloads:\n  braked:\n'
                   '    inertia: {value: 40.0, source: assumed}\n'
                   '    drag: {value: 0.0, source: assumed}\n')


def _part(copied: PatchedCopy) -> None:
    copied.add('isa_ros/plant/buffer.py', _BUFFER)
    plant, rates = 'isa_ros/plant/plant.py', 'isa_ros/plant/rates.py'
    copied.replace(plant, 'from isa_ros.plant.counterbalance import',
                   'from isa_ros.plant.buffer import Buffer, BUFFER, buffer_record\n'
                   'from isa_ros.plant.counterbalance import')
    copied.replace(rates, 'from isa_ros.plant.cavitation import',
                   'from isa_ros.plant.buffer import buffer_force\n'
                   'from isa_ros.plant.cavitation import')
    copied.replace(plant, "    ('thermal', thermal.THERMAL),\n",
                   "    ('thermal', thermal.THERMAL),\n    ('buffer', BUFFER),\n")
    copied.replace(plant, '    thermal: NoneThermal | LumpedThermal',
                   '    buffer: Buffer = nested(Buffer(length=0.0, damping=0.0))\n'
                   '    thermal: NoneThermal | LumpedThermal')
    copied.replace(plant, '        thermal=thermal.thermal_record(',
                   '        buffer=buffer_record(sheet.buffer),\n'
                   '        thermal=thermal.thermal_record(')
    force = 'f_stop = mechanics.stop_force(s, v, plant.chambers.stroke, plant.mechanics)\n'
    copied.replace(rates, force, f'{force}    f_stop += buffer_force('
                   's, v, plant.chambers.stroke, plant.buffer)\n')


def _block(copied: PatchedCopy) -> None:
    wiring, cascade = 'isa_ros/reu/wiring.py', 'isa_ros/reu/cascade.py'
    copied.add('isa_ros/reu/proportional.py', _PROPORTIONAL)
    for path, names in ((wiring, 'Proportional'), (
            cascade, 'Proportional, PROPORTIONAL, proportional_record, proportional_step')):
        after = 'from isa_ros.reu.protection import' if path == cascade else (
            'from isa_ros.reu.protection_sheet import')
        copied.replace(path, after, f'from isa_ros.reu.proportional import {names}\n{after}')
    copied.replace(wiring, 'LEADS_AND_LAGS = range(6)', 'LEADS_AND_LAGS, GAINS = range(7)')
    copied.replace(wiring, 'LeadLag: LEADS_AND_LAGS}', 'LeadLag: LEADS_AND_LAGS, '
                   'Proportional: GAINS}')
    copied.replace(wiring, 'force: Off | Pid | FeedbackLinearisation',
                   'force: Off | Pid | FeedbackLinearisation | Proportional')
    copied.replace(cascade, 'delay_steps, IMPEDES,', 'delay_steps, GAINS, IMPEDES,')
    copied.replace(cascade, "    ('lead_lag', LEAD_LAG),\n",
                   "    ('lead_lag', LEAD_LAG), ('proportional', PROPORTIONAL),\n")
    copied.replace(cascade, '    if isinstance(reu.current, LeadLag):\n',
                   '    if isinstance(reu.force, Proportional):\n'
                   "        row['proportional'] = proportional_record(reu.force)\n"
                   '    if isinstance(reu.current, LeadLag):\n')
    linear = '            if reu.force_kind == LINEARISES:\n'
    copied.replace(cascade, linear, '            if reu.force_kind == GAINS:\n'
                   '                proportional_step(reference, state.measured.force,\n'
                   '                                  reu.proportional, state.force)\n'
                   f'{linear.replace("if", "elif")}')
    copied.replace('isa_ros/config/data/models/isa_v5.yaml', '\nvariants:\n', _VARIANT)


@pytest.fixture(scope='module')
def extended(tmp_path_factory: pytest.TempPathFactory) -> Extended:
    """Return a copy of the package with all extensions."""
    copied = PatchedCopy(tmp_path_factory.mktemp('extended'))
    return Extended(copied, *(copied.touched_by(each) for each in (
        _condition, _sensor, _load, _part, _block)))


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
