"""Gains that change while the current still fades from a change of mode: unit and run alike."""

from isa_ros.export.fmi.description import Version
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import numpy as np
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import Unit  # noqa: E402
from tests.export.fmi.runs import SAMPLED  # noqa: E402

pytestmark = pytest.mark.slow
BEHIND = 71
"""Bytes behind the snapshot: its digest 16, fed 32, checksum 8, up to a word 7, the unit's 8."""

# By tick: what the unit is set to, the command of the run, and the gains that both get.
COURSE = {
    5: ({'setpoint.position': 0.06}, {'position': 0.06, 'velocity': 0.0, 'effort': 0.0}, {}),
    15: ({}, None, {'reu.force.kp': 3e-7}),                        # nothing fades yet
    30: ({'mode': 2, 'reference': 4e-5}, {'mode': 'spool', 'spool': 4e-5}, {}),
    33: ({}, None, {'reu.force.kp': 2e-7}),                        # of a loop that is off
    45: ({'mode': 6}, {'mode': 'impedance'}, {}),
    46: ({}, None, {'reu.force.kp': 1.3e-7}),
    47: ({}, None, {'reu.force.kp': 4e-7, 'reu.force.kv': 0.02}),  # twice within one fade
    48: ({}, None, {'reu.position.force_out': 300.0}),             # the first of all, alone
    49: ({}, None, {'reu.force.kp': 3e-7}),
    60: ({'mode': 4, 'setpoint.effort': -200.0},
         {'mode': 'force', 'position': 0.06, 'velocity': 0.0, 'effort': -200.0},
         {'reu.force.offset': 2e-6}),                              # at the tick of the change
    63: ({'setpoint.stiffness': 3e5}, {'stiffness': 3e5}, {'reu.force.setpoint_weight': 0.6}),
    80: ({'enable': False}, {'is_enabled': False}, {}),
    81: ({}, None, {'reu.force.kp': 9e-8, 'reu.force.limit': 1e-4}),    # while it comes to rest
    120: ({}, None, {'reu.force.ki': 1e-5}),                       # disabled: there is no current
    130: ({'enable': True, 'mode': 6}, {'is_enabled': True, 'mode': 'impedance'}, {}),
    150: ({'setpoint.position': 0.05, 'setpoint.effort': 0.0},
          {'position': 0.05, 'velocity': 0.0, 'effort': 0.0}, {}),
    170: ({'quick_stop': True}, {'quick_stop': True}, {'reu.force.kd': 1e-9}),
    173: ({}, None, {'reu.force.kp': 2.5e-7})}
FADING, QUIET = (33, 46, 47, 48, 49, 63, 173), (15, 120)
"""Ticks of a change at which a current fades, and at which none does."""


class Beside:
    """A unit, and the run of its actuator, which get the same."""

    def __init__(self, case, version, directory):
        self.unit = Unit(case.paths[version], directory)
        self.simulation = Simulation(idle(case.run.configuration))
        self.actuator = self.simulation.group.actuators[0]
        snapshot = self.actuator.snapshot()
        self.begin = -len(snapshot) - BEHIND
        self.own_bytes = len(snapshot) - len(self.actuator.tuning.snapshot())

    def give(self, values, command, changes):
        """Give both what the course has for a tick."""
        self.unit.set({**values, **changes})
        if command is not None:
            self.simulation.command('ram', **command)
        if changes:
            self.simulation.tune('ram', changes)

    def step(self, k, n=1):
        """Advance both by n ticks; they have the same samples and states."""
        self.unit.step(n)
        for _ in range(n):
            self.simulation.step()
        sample = self.simulation.observed['ram']
        expected = np.array([float(sample[name]) for name in SAMPLED])
        assert self.unit.numbers([*SAMPLED]).tobytes() == expected.tobytes(), k
        assert self.of_unit(self.unit) == self.of_run(), k
        assert self.unit.messages == []

    def of_unit(self, unit):
        """Return the state of the actuator in a unit, without the values that may change."""
        return unit.state()[self.begin:][:self.own_bytes]

    def of_run(self):
        """Return it in the run, likewise."""
        return self.actuator.snapshot()[:self.own_bytes]

    @property
    def fades(self):
        """Return whether the current of the run still fades."""
        return bool(self.actuator.memory.reu['status']['fade']['is_on'][0])


@pytest.mark.parametrize('version', Version)
def test_a_gain_that_changes_within_a_fade_has_the_effect_of_the_run(version, cases, tmp_path):
    both = Beside(cases('at_once'), version, tmp_path / 'unit')
    fading, states = set(), set()
    for k in range(220):
        if both.fades:
            fading.add(k)
        both.give(*COURSE.get(k, ({}, None, {})))
        both.step(k)
        states.add(int(both.simulation.observed['ram'].device_state))
    assert fading.issuperset(FADING) and fading.isdisjoint(QUIET)
    assert len(states) >= 3


def test_a_fade_goes_on_through_a_step_of_many_ticks(cases, tmp_path):
    both = Beside(cases('at_once'), Version.FMI3, tmp_path / 'unit')
    for k in (5, 15, 30):
        both.give(*COURSE[k])
        both.step(k, 4)
    both.give(*COURSE[45])
    both.step(45)
    assert both.fades
    both.give(*COURSE[46])
    both.step(46, 7)
    assert both.fades
    both.step(53, 200)
    assert not both.fades


def test_a_state_within_a_fade_has_the_change_of_a_gain(cases, tmp_path):
    case = cases('at_once')
    both, other = Beside(case, Version.FMI3, tmp_path / 'unit'), None
    for k in range(70):
        both.give(*COURSE.get(k, ({}, None, {})))
        if k in FADING:     # the change is written, its step not made
            other = Unit(case.paths[Version.FMI3], tmp_path / 'unit')
            other.restore(both.unit.state())
            other.n_steps = k
        both.step(k)
        if k in FADING:
            other.step()
            assert both.of_unit(other) == both.of_run(), k
