"""All actuators of a run in this process, called directly."""

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import HAS_SETPOINT, START
from isa_ros.errors import ConfigError
from isa_ros.tick.exchange import Rows
from isa_ros.tick.in_process import InProcess
import numpy as np
import pytest
from tests.runs import run_of

CONFIGS = [default_actuator('isa_v5', name) for name in ('hip', 'knee')]


class Input:
    """A node that writes down when it serves."""

    def __init__(self, name: str, log: list[str]) -> None:
        self._name, self._log = name, log

    def serve(self) -> None:
        self._log.append(f'{self._name} serves')


def make_group() -> ActuatorGroup:
    return ActuatorGroup(CONFIGS, DEFAULT_TIMING)


def make_transport(inputs=(), group: ActuatorGroup | None = None) -> InProcess:
    """Return two actuators that start at places of their own."""
    starts = np.zeros(len(CONFIGS), START)
    starts['position'], starts['supply_pressure'] = (0.03, 0.04), 20.7e6
    return InProcess(group or make_group(), starts, inputs)


def make_rows(transport: InProcess) -> Rows:
    """Return the memory of a run in which only the second actuator is commanded."""
    rows = Rows(len(CONFIGS), surroundings_of(run_of(*CONFIGS)), transport.group)
    rows.ports['supply_pressure'] = 20.7e6
    rows.commands['stiffness'] = rows.commands['damping'] = np.nan
    rows.commands['kinds'], rows.commands['position'] = (0, HAS_SETPOINT), 0.05
    return rows


def said(rows: Rows) -> tuple:
    """Return everything that the actuators have put into the rows."""
    return (rows.replies.tobytes(), rows.samples.tobytes(), rows.applied.tobytes(), rows.tuned)


def test_everyone_starts_where_its_row_says():
    """With the initial setpoint in force, and the parameters that the configuration says."""
    transport = make_transport()
    rows = make_rows(transport)
    transport.join(rows)
    # The sensor of a start without force is not strained: the encoder reads the position.
    assert rows.samples['position'].tolist() == [
        pytest.approx(0.03, abs=1e-6), pytest.approx(0.04, abs=1e-6)]
    assert rows.applied['position'].tolist() == rows.samples['position'].tolist()
    assert rows.applied['kinds'].all()
    assert rows.tuned == {}


def test_all_serve_their_inputs_before_the_tick():
    """What arrived is in force from this tick on: a parameter that an input sets as it serves."""
    log: list[str] = []
    group = make_group()
    inputs = [Input(own.name, log) for own in CONFIGS]
    transport = make_transport(inputs, group)
    rows = make_rows(transport)
    transport.join(rows)
    transport.begin()
    transport.send(0, rows)
    assert log == []
    inputs[0].serve = lambda: group.actuators[0].tune({'force.kp': 1e-7})
    transport.receive(rows)
    assert log == ['knee serves']
    assert rows.tuned == {0: {'force.kp': 1e-7}}


def test_a_paused_run_serves_its_inputs():
    log: list[str] = []
    transport = make_transport([Input(own.name, log) for own in CONFIGS])
    transport.join(make_rows(transport))
    transport.idle()
    assert log == ['hip serves', 'knee serves']


def test_a_command_reaches_its_actuator_alone():
    transport = make_transport()
    rows = make_rows(transport)
    transport.join(rows)
    transport.receive(rows)
    assert rows.applied['kinds'].tolist() == [0, HAS_SETPOINT]
    assert rows.applied['position'][1] == 0.05
    assert (rows.replies['position'] > 0.0).all()


def test_each_goes_on_from_its_own_snapshot():
    """What is shown first is of the instant it goes on from, and the rest is the same."""
    transport = make_transport()
    rows = make_rows(transport)
    transport.join(rows)
    transport.group.actuators[0].tune({'force.kp': 1e-7})
    transport.receive(rows)
    assert rows.tuned == {0: {'force.kp': 1e-7}}
    then, snapshots = said(rows), transport.snapshots()
    rows.commands['kinds'] = 0
    later = []
    for _ in range(3):
        transport.receive(rows)
        later.append(said(rows))
    other = make_transport()
    fresh = make_rows(other)
    other.join(fresh)
    other.restore(1, snapshots, fresh)
    assert said(fresh) == then
    fresh.commands['kinds'] = 0
    for expected in later:
        other.receive(fresh)
        assert said(fresh) == expected
    with pytest.raises(ConfigError, match='the saved state has 1 participants, the run has 2'):
        other.restore(7, snapshots[:1], fresh)


def test_a_second_run_begins_as_the_first():
    """What was commanded and tuned in the first is forgotten."""
    group = make_group()
    transport = make_transport(group=group)
    rows = make_rows(transport)
    runs = []
    for _ in range(2):
        transport.join(rows)
        own = [said(rows)]
        group.actuators[0].tune({'force.kp': 1e-7})
        for _ in range(3):
            transport.receive(rows)
            own.append(said(rows))
        runs.append(own)
    assert runs[0] == runs[1]
