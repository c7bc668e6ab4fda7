"""
The keys of a scenario's file: what their readers accept, and `docs/scenario_file.md` lists.

The keys of a waveform or gait are the parameters of its class.
"""

from collections.abc import Mapping
from typing import NamedTuple

REQUIRED = 'required'
_TRUE = 'true'
_ADDED = 'the setpoint'


class Row(NamedTuple):
    """What a key takes, and what it means."""

    value: str
    default: str
    meaning: str


SCENARIO: Mapping[str, Row] = {
    'name': Row('name', REQUIRED, 'the name of the scenario, of its bag and report'),
    'figure': Row('name', 'none', 'figure of the paper that `isa report` begins with'),
    'duration_s': Row('number, s', REQUIRED, 'of the run, whole ticks'),
    'beyond_range': Row('accept', 'limited', (
        'takes setpoints beyond the range of their actuators as they are')),
    'leg': Row('section', 'of the run file', 'start of the body `leg`, as in the run file'),
    'bodies': Row('sections by name', 'of the run file', 'starts of other bodies'),
    'loads': Row('sections by actuator', 'of the run file', 'loads instead of those of the run'),
    'controllers': Row('list of names, or sections by name', 'of the run file', (
        'controllers, as in the run file')),
    'tracks': Row('lists of setpoints by actuator', 'none', (
        'setpoints of an actuator, in ascending order of time; without any it holds its start')),
    'faults': Row('list', 'none', 'what fails, below'),
    'changes': Row('list', 'none', (
        'what changes and is no fault, such as the force on a load; of the same form')),
}
ROBOTS = Row('sections by robot', 'none', (
    '`file` of each robot of a run with `robots`, and keys above in place of those of the file'))
SETPOINT: Mapping[str, Row] = {
    't_s': Row('number, s', REQUIRED, 'when it takes effect, at a tick'),
    'position': Row('number, m or rad, or hold', 'required in mode impedance and position', (
        'equilibrium; hold: where the actuator starts')),
    'velocity': Row('number, m/s or rad/s', '0', 'of the equilibrium'),
    'effort': Row('number, N or Nm', '0', 'feed-forward; in mode force what is wanted'),
    'stiffness': Row('number, N/m or Nm/rad', 'unchanged', 'of the impedance block'),
    'damping': Row('number, N s/m or Nm s/rad', 'unchanged', 'of the impedance block'),
    'enabled': Row('true or false', 'unchanged', 'enables, or disables'),
    'mode': Row('name', 'unchanged', (
        'control mode: current, spool, pressure, force, position or impedance')),
    'current': Row('number, A', 'none', 'reference in mode current'),
    'spool': Row('number, m', 'none', 'reference in mode spool'),
    'pressure': Row('number, Pa', 'none', 'reference in mode pressure, of the load pressure'),
    'clear_fault': Row(_TRUE, 'none', 'clears the faults whose causes are gone'),
    'quick_stop': Row(_TRUE, 'none', 'stops as `reu.device.quick_stop` says'),
    'sine': Row('section', 'none', f'a sine that is added to {_ADDED}'),
    'chirp': Row('section', 'none', f'a sine of changing frequency, added to {_ADDED}'),
    'pulse': Row('section', 'none', f'a train of steps, added to {_ADDED}'),
    'ramp': Row('section', 'none', f'a way at constant speed from {_ADDED}, where it stays'),
    'gait': Row('section', 'none', 'the motion of one joint in a trot'),
}
FAULT: Mapping[str, Row] = {
    't_s': Row('number, s', REQUIRED, 'when it begins, at a tick'),
    'actuator': Row('name', 'one of these', 'the actuator whose parameters change'),
    'supply': Row('name', 'one of these', 'the supply whose parameters change'),
    'link': Row('name of an actuator', 'one of these', 'whose modelled link changes'),
    'bus': Row('name of an actuator', 'one of these', 'whose connection to a bus changes'),
    'body': Row('name', 'one of these', 'the body that is pushed'),
    'emergency_stop': Row('name of a group, or all', 'one of these', 'the line that opens'),
    'part': Row('name', 'none', 'the part of a circuit whose keys `set` has'),
    'fault': Row('name', '`set` is required', 'one of the catalogue, `isa faults`'),
    'set': Row('values by key of `isa params`', '`fault` is required', 'the values'),
    'until_s': Row('number, s', 'to the end', 'when it ends, at a tick'),
    'ramp_s': Row('number, s', '0, it jumps', 'time in which values go from those of the sheet'),
    'intermittent': Row('section', 'none', (
        'on for `duty`, a part of each `period_s`; with `seed` for periods drawn with that '
        'chance')),
    'sine': Row('section', 'none', 'a sine that is added to the one value of `set`'),
    'chirp': Row('section', 'none', 'likewise, of changing frequency'),
    'pulse': Row('section', 'none', 'likewise, a train of steps'),
}
