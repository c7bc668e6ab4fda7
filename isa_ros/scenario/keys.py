"""
The keys of a scenario's file: what their readers accept, and `docs/scenario_file.md` lists.

The keys of a waveform or gait are the parameters of its class.
"""

from collections.abc import Mapping
from typing import NamedTuple

REQUIRED = 'required'
_TRUE = 'true'
_ADDED = 'the setpoint'


class KeyRow(NamedTuple):
    """What a key takes, and what it means."""

    value: str
    default: str
    meaning: str


SCENARIO: Mapping[str, KeyRow] = {
    'name': KeyRow('name', REQUIRED, 'the name of the scenario, of its bag and report'),
    'figure': KeyRow('name', 'none', 'figure of the paper that `isa report` begins with'),
    'duration_s': KeyRow('number, s', REQUIRED, 'of the run, whole ticks'),
    'beyond_range': KeyRow('accept', 'of the actuators', (
        'takes setpoints beyond the range of their actuators as they are')),
    'leg': KeyRow('section', 'of the run file', 'start of the body `leg`, as in the run file'),
    'bodies': KeyRow('sections by name', 'of the run file', 'starts of other bodies'),
    'loads': KeyRow(
        'sections by actuator', 'of the run file', 'loads instead of those of the run'),
    'controllers': KeyRow('list of names, or sections by name', 'of the run file', (
        'controllers, as in the run file')),
    'tracks': KeyRow('lists of setpoints by actuator', 'none', (
        'setpoints of an actuator, in ascending order of time; without any it holds its start')),
    'faults': KeyRow('list', 'none', 'what fails, below'),
    'changes': KeyRow('list', 'none', (
        'what changes and is no fault, such as the force on a load; of the same form')),
}
ROBOTS = KeyRow('sections by robot', 'none', (
    '`file` of each robot of a run with `robots`, and keys above in place of those of the file'))
SETPOINT: Mapping[str, KeyRow] = {
    't_s': KeyRow('number, s', REQUIRED, 'when it takes effect, at a tick'),
    'position': KeyRow('number, m or rad, or hold', 'required in mode impedance and position', (
        'equilibrium; hold: where the actuator starts')),
    'velocity': KeyRow('number, m/s or rad/s', '0', 'of the equilibrium'),
    'effort': KeyRow('number, N or Nm', '0', 'feed-forward; in mode force what is wanted'),
    'stiffness': KeyRow('number, N/m or Nm/rad', 'unchanged', 'of the impedance block'),
    'damping': KeyRow('number, N s/m or Nm s/rad', 'unchanged', 'of the impedance block'),
    'enabled': KeyRow('true or false', 'unchanged', 'enables, or disables'),
    'mode': KeyRow('name', 'unchanged', (
        'control mode: current, spool, pressure, force, position or impedance')),
    'current': KeyRow('number, A', 'none', 'reference in mode current'),
    'spool': KeyRow('number, m', 'none', 'reference in mode spool'),
    'pressure': KeyRow('number, Pa', 'none', 'reference in mode pressure, of the load pressure'),
    'clear_fault': KeyRow(_TRUE, 'none', 'clears the faults whose causes are gone'),
    'quick_stop': KeyRow(_TRUE, 'none', 'stops as `reu.device.quick_stop` says'),
    'sine': KeyRow('section', 'none', f'a sine that is added to {_ADDED}'),
    'chirp': KeyRow('section', 'none', f'a sine of changing frequency, added to {_ADDED}'),
    'pulse': KeyRow('section', 'none', f'a train of steps, added to {_ADDED}'),
    'ramp': KeyRow('section', 'none', f'a way at constant speed from {_ADDED}, where it stays'),
    'gait': KeyRow('section', 'none', 'the motion of one joint in a trot'),
}
FAULT: Mapping[str, KeyRow] = {
    't_s': KeyRow('number, s', REQUIRED, 'when it begins, at a tick'),
    'actuator': KeyRow('name', 'one of these', 'the actuator whose parameters change'),
    'supply': KeyRow('name', 'one of these', 'the supply whose parameters change'),
    'link': KeyRow('name of an actuator', 'one of these', 'whose modelled link changes'),
    'bus': KeyRow('name of an actuator', 'one of these', 'whose connection to a bus changes'),
    'body': KeyRow('name', 'one of these', 'the body that is pushed'),
    'emergency_stop': KeyRow('name of a group, or all', 'one of these', 'the line that opens'),
    'part': KeyRow('name', 'none', 'the part of a circuit whose keys `set` has'),
    'fault': KeyRow('name', '`set` is required', 'one of the catalogue, `isa faults`'),
    'set': KeyRow('values by key of `isa params`', '`fault` is required', 'the values'),
    'until_s': KeyRow('number, s', 'to the end', 'when it ends, at a tick'),
    'ramp_s': KeyRow(
        'number, s', '0, it jumps', 'time in which values go from those of the sheet'),
    'intermittent': KeyRow('section', 'none', (
        'on for `duty`, a part of each `period_s`; with `seed` for periods drawn with that '
        'chance')),
    'sine': KeyRow('section', 'none', 'a sine that is added to the one value of `set`'),
    'chirp': KeyRow('section', 'none', 'likewise, of changing frequency'),
    'pulse': KeyRow('section', 'none', 'likewise, a train of steps'),
}
