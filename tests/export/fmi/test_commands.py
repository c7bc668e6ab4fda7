"""Each input of a unit is the command that it is in a run, at the tick of its change."""

from isa_ros.core.device import MODES
from isa_ros.core.objects import own_target
from isa_ros.export.chosen import choose
from isa_ros.export.fmi.description import Version
from isa_ros.export.fmi.unit import archive, made, parts_of
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import numpy as np
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import Unit  # noqa: E402
from tests.export.fmi.runs import SAMPLED  # noqa: E402

pytestmark = pytest.mark.slow

# By tick: what the unit is set to, and the command of the run, which is none for some.
COURSE = {
    5: ({'setpoint.position': 0.055}, {'position': 0.055, 'velocity': 0.0, 'effort': 0.0}),
    25: ({'setpoint.velocity': 0.01}, {'position': 0.055, 'velocity': 0.01, 'effort': 0.0}),
    40: ({'setpoint.effort': 150.0}, {'position': 0.055, 'velocity': 0.01, 'effort': 150.0}),
    50: ({'setpoint.stiffness': 3e5}, {'stiffness': 3e5}),
    60: ({'setpoint.damping': 9000.0}, {'damping': 9000.0}),
    70: ({'setpoint.position': 0.05, 'setpoint.stiffness': 2e5},
         {'position': 0.05, 'velocity': 0.01, 'effort': 150.0, 'stiffness': 2e5}),
    80: ({'setpoint.position': 0.05},      # again: it is a setpoint, too
         {'position': 0.05, 'velocity': 0.01, 'effort': 150.0}),
    85: ({'enable': True}, None),          # it is
    90: ({'clear_fault': True}, {'clear_fault': True}),
    91: ({'clear_fault': True}, None),     # no edge
    93: ({'clear_fault': False}, None),
    95: ({'clear_fault': True}, {'clear_fault': True}),
    100: ({'mode': 2, 'reference': 3e-5}, {'mode': 'spool', 'spool': 3e-5}),
    110: ({'reference': -2e-5}, {'spool': -2e-5}),
    120: ({'mode': 1, 'reference': 1e-3}, {'mode': 'current', 'current': 1e-3}),
    130: ({'mode': 4, 'setpoint.effort': -200.0},
          {'mode': 'force', 'position': 0.05, 'velocity': 0.01, 'effort': -200.0}),
    140: ({'reference': 5.0}, None),       # not of this mode
    150: ({'enable': False}, {'is_enabled': False}),
    170: ({'enable': True, 'mode': 6}, {'is_enabled': True, 'mode': 'impedance'}),
    200: ({'quick_stop': True}, {'quick_stop': True}),
    205: ({'quick_stop': True}, None),
    250: ({'enable': True}, None),         # as before: it stays disabled
    260: ({'quick_stop': False, 'enable': False}, {'is_enabled': False}),
    270: ({'enable': True}, {'is_enabled': True}),
}


@pytest.mark.parametrize('version', Version)
def test_every_input_has_the_effect_of_its_command(version, cases, tmp_path):
    case = cases('own_load')
    unit = Unit(case.paths[version], tmp_path / 'unit')
    simulation = Simulation(idle(case.run.configuration))
    states, modes = set(), set()
    for k in range(300):
        values, command = COURSE.get(k, ({}, None))
        unit.set(values)
        unit.step()
        if command is not None:
            simulation.command('ram', **command)
        simulation.step()
        own = simulation.observed['ram']
        expected = np.array([float(own[name]) for name in SAMPLED])
        assert unit.numbers([*SAMPLED]).tobytes() == expected.tobytes(), (k, unit.messages)
        states.add(int(own.device_state))
        modes.add(MODES[int(own.device_mode)])
    assert unit.messages == []
    assert modes == {'impedance', 'spool', 'current', 'force'} and len(states) >= 3
    assert simulation.observed['ram'].refused_requests >= 2.0
    assert simulation.observed['ram'].unused_setpoints == 0.0


def test_the_reference_of_pressure_is_taken_in_its_mode(tmp_path):
    chosen = choose('isa_v5', variants=['pressure_control'], load='own')
    own = made(parts_of(chosen), own_target())
    (tmp_path / 'unit.fmu').write_bytes(archive(own, Version.FMI3))
    unit, simulation = Unit(tmp_path / 'unit.fmu', tmp_path / 'unit'), Simulation(idle(chosen.run))
    name, = simulation.names
    course = {5: ({'mode': 3, 'reference': 1.5e6}, {'mode': 'pressure', 'pressure': 1.5e6}),
              15: ({'reference': -1.5e6}, {'pressure': -1.5e6})}
    differences = []
    for k in range(25):
        values, command = course.get(k, ({}, None))
        unit.set(values)
        unit.step()
        if command is not None:
            simulation.command(name, **command)
        simulation.step()
        sample = simulation.observed[name]
        expected = np.array([float(sample[field]) for field in SAMPLED])
        assert unit.numbers([*SAMPLED]).tobytes() == expected.tobytes(), k
        differences.append(unit.get('pressure_a') - unit.get('pressure_b'))
    assert unit.messages == [] and unit.get('device_mode') == 3
    assert differences[4] + 5e5 < differences[14] > differences[24] + 5e5
