"""The barrier and the run: order of a tick, what is recorded, and how a run ends."""

from isa_ros.errors import RunError, SimulationDiverged
from isa_ros.run.coordinator import Coordinator, Interrupted
from isa_ros.run.pacing import Pace
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.tick.exchange import Rows
import numpy as np
import pytest
from tests.run.rig import clock_line, Rig


def test_n_ticks_give_n_plus_1_samples():
    rig = Rig(3)
    rig.run()
    assert rig.sequences == [0, 1, 2, 3]
    assert [t_ns for t_ns, _, _ in rig.recorder.samples] == [0, 1_000_000, 2_000_000, 3_000_000]


def test_order_of_a_tick():
    """Clock of the tick's end first; the last sample is recorded while actuators work."""
    rig = Rig(2)
    rig.run()
    assert rig.log == [
        'clock 0', 'begin', 'publish',
        'clock 1000000', 'send 0 x0=0 kinds=[0, 0]', 'record 0',
        'receive 0', 'advance 0', 'publish',
        'clock 2000000', 'send 1 x0=1 kinds=[0, 1]', 'record 1',
        'receive 1', 'advance 1', 'publish',
        'record 2']


def test_every_sample_is_of_its_own_instant():
    """The clock in it, what was applied at its tick's start, and what was tuned then."""
    rig = Rig(2)
    rig.run()
    said = [{rig.topics[k]: data for k, data in messages}
            for _, _, messages in rig.recorder.samples]
    assert [clock_line(own['/clock']) for own in said] == ['clock 0', 'clock 1000000',
                                                           'clock 2000000']
    assert ['/hip/applied_setpoint' in own for own in said] == [True, False, True]
    assert ['/knee/applied_parameters' in own for own in said] == [False, False, True]
    assert [sorted(own) == list(own) for own in said] == [True] * 3


def test_stop_finishes_the_tick_and_records_it():
    rig = Rig(None)
    rig.stops_at = 2
    with pytest.raises(Interrupted, match=r't = 0\.002000 s after 2 ticks') as raised:
        rig.run()
    assert raised.value.exit_code == 130
    assert rig.sequences == [0, 1, 2] and not rig.events
    assert rig.log[-2:] == ['publish', 'record 2']


@pytest.mark.parametrize('failure', [
    RunError('kfe: no answer to tick 2'), SimulationDiverged(3_000_000, 'kfe: spool', np.nan)])
def test_finished_ticks_are_recorded_when_an_actuator_fails(failure):
    rig = Rig(9)
    rig.transport.failure, rig.transport.fails_at = failure, 2
    with pytest.raises(type(failure)) as raised:
        rig.run()
    assert raised.value is failure
    assert rig.sequences == [0, 1, 2, 2]    # its samples, which are recorded already; the event
    assert rig.events == {2: [f'ended by an error: {failure}']}


def test_an_error_between_two_ticks_is_recorded_with_the_last_one():
    """One of the body: what it gives is not sent."""
    rig = Rig(9)

    def ports(ports):
        if rig.loop.ticks == 2:
            raise SimulationDiverged(2_000_000, 'body.port_x0[0] (hip)', np.nan)
        ports['x0'] = 0.0
    rig.loop._surroundings.ports = ports
    with pytest.raises(SimulationDiverged):
        rig.run()
    assert rig.sequences == [0, 1, 2]
    assert rig.events[2][0].startswith('ended by an error: body.port_x0[0] (hip) = nan at t = 0.0')
    assert rig.log[-2].startswith('event ended by an error') and rig.log[-1] == 'record 2'


def test_lost_recorder_ends_the_run():
    rig = Rig(9)

    def write_tick(t_ns, sequence, messages):
        if sequence == 2:
            raise RunError('drop_0.mcap: cannot record, No space left on device')
        rig.recorder.samples.append((t_ns, sequence, list(messages)))
    rig.recorder.write_tick = write_tick
    with pytest.raises(RunError, match='No space left'):
        rig.run()
    assert rig.sequences == [0, 1]
    assert rig.coordinator.ticks == 2


def test_what_a_controller_asks_for_takes_effect_once_at_the_next_tick():
    """Asked in tick 0, in force from tick 1; the scenario writes over it."""
    rig = Rig(3)
    rig.transport.asks_at = 0
    rig.run()
    assert [line for line in rig.log if line.startswith('send')] == [
        'send 0 x0=0 kinds=[0, 0]', 'send 1 x0=1 kinds=[1, 1]', 'send 2 x0=2 kinds=[0, 2]']


def test_faults_change_supplies_and_actuators_before_the_tick_of_their_time():
    """And only there: the transport finds them in its rows when it starts that tick."""
    at_1 = ParameterChanges({1: {'plant.spool.stuck': 1.0}}, {'supply.pressure_mpa': 10.0})
    seen = []
    rig = Rig(3, changes={1: at_1}.get)
    sent = rig.transport.send

    def send(tick: int, rows: Rows) -> None:
        seen.append((tick, dict(rows.changes), 'tune' in rig.log[-1]))
        sent(tick, rows)
    rig.transport.send = send
    rig.run()
    assert [changes for _, changes, _ in seen] == [{}, dict(at_1.actuators), {}]
    assert [line for line in rig.log if 'tune' in line] == ["tune {'supply.pressure_mpa': 10.0}"]


def test_a_tick_waits_for_its_commands():
    """Requests and the inputs of actuators are served meanwhile, with the sample of the tick."""
    rig = Rig(2)
    rig.source.waits = {1: 2}
    rig.run()
    start = rig.log.index('no command 1 position=1')
    assert rig.log[start:start + 5] == [
        'no command 1 position=1', 'inputs', 'no command 1 position=1', 'inputs',
        'clock 2000000']
    assert rig.looks == 2 + 2 + 1
    assert rig.sequences == [0, 1, 2]


def test_a_step_waits_for_the_commands_of_each_tick():
    rig = Rig(3, is_paused=True)
    rig.source.waits = {0: 1, 1: 1}
    rig.asked = {0: lambda run: run.step(2), 2: lambda run: run.pause(False)}
    rig.run()
    assert rig.sequences == [0, 1, 2, 3]
    assert rig.log.index('no command 1 position=1') < rig.log.index('idle')


def test_a_stop_ends_the_wait_for_commands():
    rig = Rig(3)
    rig.source.waits, rig.stops_at = {1: 1_000_000}, 1
    with pytest.raises(Interrupted, match='after 1 ticks'):
        rig.run()
    assert rig.sequences == [0, 1]


def test_events_of_the_source_are_recorded_at_their_tick():
    rig = Rig(3)
    rig.source.happened = {2: 'bus lost'}
    rig.run()
    assert rig.events == {2: ['bus lost']}


def test_the_source_sees_what_is_tuned():
    """After the tick at whose start it changed, and only then."""
    rig = Rig(3)
    rig.run()
    assert rig.source.told == {rig.log.index('receive 1') + 1: {1: {'force.kp': 1e-7}}}


def test_the_source_has_the_last_samples():
    rig = Rig(3)
    rig.run()
    assert rig.source.ended == (3, 3.0)


def test_host_time_before_the_first_tick_does_not_count():
    """A minute passes before the first commands: the run is not behind its pace then."""
    host = [0.0]

    def sleep(seconds: float) -> None:
        host[0] += seconds
    pace = Pace(1.0, lambda: host[0], sleep)
    rig = Rig(2, pace=pace)
    rig.source.waits = {0: 1}

    def wait_a_minute(coordinator: Coordinator) -> None:
        host[0] += 60.0
    rig.asked = {0: wait_a_minute, 1: wait_a_minute}
    rig.run()
    assert pace.shortfall is None
