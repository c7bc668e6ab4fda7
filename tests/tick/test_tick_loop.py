"""One tick: who commands, in which order rows are given out, and where a run can go on."""

from collections.abc import Mapping
from types import SimpleNamespace

from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.errors import ConfigError
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.quiet import QuietEnd
from isa_ros.tick.source import ScheduledSource
import numpy as np
import pytest
from tests.runs import CONSTANT, hip_and_knee
from tests.sheets import setpoint

RUN = hip_and_knee([SupplyConfig('constant', CONSTANT, ('hip', 'knee'))])


class AsksOnce(Controller):
    """Asks both actuators at one tick, and keeps the pressures that it sees."""

    def __init__(self, at: int) -> None:
        self.at, self.pressures = at, []

    def step(self, state: State) -> Mapping[str, Setpoint]:
        self.pressures.append(float(state.supplies['constant'].pressure))
        if state.t_ns != self.at * RUN.step_ns:
            return {}
        return {'hip': Setpoint(0.04), 'knee': Setpoint(0.05)}

    def snapshot(self) -> bytes:
        return b''

    def restore(self, snapshot: bytes) -> None:
        pass


class Noting(RowSink):
    """Writes down what it is given, and the ticks that the simulation has finished by then."""

    def __init__(self, simulation: Simulation) -> None:
        self.log: list[tuple] = []
        self._simulation = simulation

    def take_time(self, tick: int) -> None:
        self.log.append(('time', tick, self._simulation.group.t_ns // RUN.step_ns))

    def take(self, tick: int, rows: Rows) -> None:
        self.log.append(('rows', tick, self._simulation.group.t_ns // RUN.step_ns))

    def add_event(self, tick: int, text: str) -> None:
        self.log.append((text, tick))

    def record(self) -> None:
        self.log.append(('record', self._simulation.group.t_ns // RUN.step_ns))

    def end(self) -> None:
        self.log.append(('end',))


def taken(simulation: Simulation) -> list[float | None]:
    """Return the position that took effect at each actuator in the last tick."""
    return [float(row['position']) if row['kinds'] & HAS_SETPOINT else None
            for row in simulation.applied]


def at_2(tick: int, rows: np.ndarray) -> None:
    """Command the knee at tick 2."""
    if tick == 2:
        rows[1] = setpoint(position=0.06)


def test_a_controller_that_asks_at_one_tick_is_obeyed_once():
    simulation = Simulation(idle(RUN), [AsksOnce(1)])
    found = []
    for _ in range(5):
        simulation.step()
        found.append(taken(simulation))
    assert found == [[None] * 2] * 2 + [[0.04, 0.05]] + [[None] * 2] * 2


@pytest.mark.parametrize(('given', 'expected'), [
    (None, [0.04, 0.06]), ({}, [0.04, 0.05]), ({0: 0.07}, [0.07, 0.05])],
    ids=['source over request', 'given instead of source', 'given over request'])
def test_requests_yield_to_the_source_and_this_to_given_rows(given, expected):
    """At the tick for which all of them command, row by row."""
    simulation = Simulation(idle(RUN), [AsksOnce(1)])
    simulation.loop.source = ScheduledSource(at_2)
    simulation.step()
    simulation.step()
    rows = None if given is None else np.zeros(2, COMMAND)
    for row, position in (given or {}).items():
        rows[row] = setpoint(position=position)
    simulation.step(rows)
    assert taken(simulation) == expected


def test_sinks_get_the_time_first_and_the_rows_when_all_have_advanced():
    """And finish with the rows before a tick while the actuators have not advanced yet."""
    simulation = Simulation(idle(RUN))
    sink = Noting(simulation)
    simulation.loop.sinks = (sink,)
    simulation.loop.source = ScheduledSource(at_2, events={1: ['pause'], 2: ['end of all']})
    simulation.loop.run(2)
    assert sink.log == [
        ('time', 0, 0), ('rows', 0, 0),
        ('time', 1, 0), ('record', 0), ('rows', 1, 1),
        ('pause', 1), ('time', 2, 1), ('record', 1), ('rows', 2, 2),
        ('end of all', 2), ('end',)]


@pytest.mark.parametrize(('ended', 'ticks', 'given'), [
    (QuietEnd.FULL, 4, []), (QuietEnd.SEEN, 5, ['time', 'rows']),
    (QuietEnd.BEGUN, 5, ['time', 'rows'])])
def test_after_quiet_ticks_the_sinks_get_the_tick_that_ended_them(
        monkeypatch, ended, ticks, given):
    """Its time, and its rows; the three before it they have kept by kernels."""
    simulation = Simulation(idle(RUN))
    loop, sink = simulation.loop, Noting(simulation)
    loop.begin()
    loop.advance()
    loop.sinks = (sink,)
    received: list[Rows] = []
    monkeypatch.setattr(loop, '_quiet_now', lambda: SimpleNamespace(run=lambda *_: (3, ended)))
    monkeypatch.setattr(loop.transport, 'receive', received.append)
    loop.advance_quietly(9)
    assert loop.ticks == ticks
    assert [own[:2] for own in sink.log] == [(what, 5) for what in given]
    assert len(received) == (ended is QuietEnd.BEGUN)


def test_quiet_ticks_are_of_the_ends_that_the_transport_has_now(monkeypatch):
    """Another run over sockets has others; none while a parameter changes, or without any."""
    loop = Simulation(idle(RUN)).loop
    monkeypatch.setattr(loop, 'stops', None)
    monkeypatch.setattr(loop, '_surroundings', SimpleNamespace(
        is_settled=True, parts=lambda *rows: ((), ())))
    made = []
    for is_settled in (True, True, False):
        ends = SimpleNamespace(parts=(), is_settled=is_settled)
        monkeypatch.setattr(loop, 'transport', SimpleNamespace(is_quiet=True, ends=ends))
        made.append(loop._quiet_now())
        assert made[-1] is None or made[-1].ends is ends
    assert made[0] is not None and made[1] is not None and made[2] is None
    monkeypatch.setattr(loop, 'transport', SimpleNamespace(is_quiet=True, ends=None))
    assert loop._quiet_now() is None


def test_what_the_source_changes_is_in_force_in_its_tick_and_given_out_after_it():
    """Of actuators by row, and of supplies; the controllers see the new pressure there too."""
    controller = AsksOnce(-1)
    simulation = Simulation(idle(RUN), [controller])
    simulation.loop.source = ScheduledSource(at_2, {1: ParameterChanges(
        {1: {'force.kp': 1e-7}}, {'constant.pressure_mpa': 10.0})})
    found = []
    for _ in range(3):
        simulation.step()
        found.append((simulation.loop.rows.tuned, simulation.loop.rows.tuned_supplies))
    changed = {1: {'force.kp': 1e-7}}, {'constant.pressure_mpa': 10.0}
    assert found == [({}, {}), changed, ({}, {})]
    assert controller.pressures == [20.7e6, 10e6, 10e6]
    assert simulation.group.samples['supply_volume'].shape == (2,)


def test_a_second_beginning_forgets_requests_and_keeps_what_was_tuned():
    simulation = Simulation(idle(RUN), [AsksOnce(1)])
    loop = simulation.loop
    loop.advance()
    simulation.tune('constant', {'pressure_mpa': 10.0})
    loop.advance()
    assert loop.rows.requests['kinds'].all()
    loop.join()
    assert (loop.ticks, loop.t_ns, loop.rows.requests['kinds'].any()) == (0, 0, False)
    assert simulation.supply_samples['constant'].pressure == 20.7e6
    loop.advance()
    assert loop.rows.tuned_supplies == {'constant.pressure_mpa': 10.0}
    assert taken(simulation) == [None, None]


def test_a_run_does_not_go_on_from_a_state_that_does_not_fit():
    """Saved with a controller, restored without."""
    saved = Simulation(idle(RUN), [AsksOnce(0)])
    saved.step()
    other = Simulation(idle(RUN))
    with pytest.raises(ConfigError, match='the saved state has 3 participants, the run has 2'):
        other.loop.restore(saved.loop.save())
    assert (other.ticks, other.group.t_ns) == (0, 0)
    assert not other.loop.rows.requests['kinds'].any()


def test_a_state_holds_the_requests_of_its_last_tick_alone():
    """What was asked for earlier is in force, and not part of what comes."""
    states = []
    for at in (0, 5):
        simulation = Simulation(idle(RUN), [AsksOnce(at)])
        for _ in range(3):
            simulation.step()
        states.append(simulation.loop.save().requests)
    assert states == [bytes(2 * COMMAND.itemsize)] * 2


def test_what_the_source_changes_once_may_be_changed_again_and_is_not_given_out_anew():
    """It is changed at its tick alone; a beginning has changed nothing yet."""
    simulation = Simulation(idle(RUN))
    simulation.loop.source = ScheduledSource(
        at_2, {0: ParameterChanges({1: {'force.kp': 1e-7}}, {})})
    simulation.step()
    simulation.tune('knee', {'force.kp': 2e-7})
    simulation.step()
    assert simulation.loop.rows.tuned == {1: {'force.kp': 2e-7}}
    simulation.loop.join()
    assert simulation.loop.rows.tuned == {}
