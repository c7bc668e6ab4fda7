"""Extensions of a copy's kernels: condition, sensor, load, part of the plant, block, wire."""

from tests.docs.patched_copy import PatchedCopy

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
_CHANNEL = """

@frozen(kw_only=True)
class TachometerChannel(Channel):

    sigma: float = _sigma('m/s | rad/s', 1.0)
    bias: float = _bias('m/s | rad/s', 10.0)
    drift_per_s: float = _drift('m/s2 | rad/s2', 1.0)


CHANNEL_ERRORS = """
_BRAKED = '''@frozen(kw_only=True)
class Braked(Parameters):
    """A mass with a drag that grows with the square of its speed."""

    inertia: float = parameter('moving mass', 'kg | kg m2', gt=0.0, le=1e4)
    drag: float = parameter('force per square of the speed', 'kg | kg m2', ge=0.0, le=1e6)
    force: float = external_force()


LocalLoad = Blocked | Wheel | Mass | Pad | DropRig | Braked
'''

_BUFFER = '''"""A friction buffer at each end of the stroke, which drags at what moves outwards."""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
import numpy as np


@frozen(kw_only=True)
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
_PROPORTIONAL = '''"""Force block without memory: its output is K_p times the error."""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters, tunable
from isa_ros.core.record import record
import numpy as np


@frozen(kw_only=True)
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
_WIRE = """\
bit_rate_mbit: {value: 5.0, source: 'derived, CAN FD'}
actuator_bits: {value: 600.0, source: assumed}
frame_bits: {value: 0.0, source: assumed}
frame_capacity_bits: {value: 0.0, source: assumed}
"""


def add_condition(copied: PatchedCopy) -> None:
    copied.replace(
        'isa_ros/core/conditions.py', ')\n"""All conditions;', _CONDITION)
    copied.replace(
        'isa_ros/reu/protection.py', _MEASURED,
        f'{_MEASURED}    values[BIT.undervoltage] = supply_pressure\n')


def add_sensor(copied: PatchedCopy) -> None:
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


def add_load(copied: PatchedCopy) -> None:
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


def add_part(copied: PatchedCopy) -> None:
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


def add_block(copied: PatchedCopy) -> None:
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


def add_wire(copied: PatchedCopy) -> None:
    copied.add('isa_ros/config/data/wires/canfd.yaml', _WIRE)
    copied.replace('isa_ros/actuator/link.py', "'can', 'serial')", "'can', 'serial', 'canfd')")
