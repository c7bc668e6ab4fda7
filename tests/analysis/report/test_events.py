"""The events of a report: what the bag of a run shows of them, and its result in memory."""

import isa_ros
from isa_ros.analysis.report.events import event_rows, events_text, MOST, recorded_events
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.bag.reader import Bag
from isa_ros.controller import Controller, Setpoint
from isa_ros.replay.replay import replay
from isa_ros.run.events import Event
from isa_ros.scripting.run import load
from isa_ros.tick.trips import TripWarning
import pytest

WAVE = {'amplitude': 200.0, 'frequency_hz': 20.0}
RIG = load('rig_linear', {
    'name': 'short', 'duration_s': 0.28, 'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.12, 'clear_fault': True},
        {'t_s': 0.125, 'position': 0.05}, {'t_s': 0.126, 'position': 0.05},
        {'t_s': 0.15, 'clear_fault': True, 'enabled': True}]},
    'changes': [
        {'t_s': 0.2, 'actuator': 'ram', 'set': {'load.force': 0}, 'sine': WAVE, 'until_s': 0.25},
        {'t_s': 0.26, 'supply': 'supply', 'set': {'pressure_mpa': 19.0}}]})
FAULT = {'t_s': 0.03, 'actuator': 'ram', 'until_s': 0.13,
         'set': {'plant.sensors.pressure_a.bias': -1e8}}
HAPPENED = [
    ('ram', 'state', 'enabled: initialised'),
    ('ram', 'change', 'plant.sensors.pressure_a.bias = -100000000 Pa'),
    ('ram', 'trip', 'load_cell_implausible, force that the pressures do not explain 2956 N > '
     '1000 N'),
    ('ram', 'warning', 'load_cell_implausible'), ('ram', 'state', 'fault: load cell implausible'),
    ('ram', 'refused', '1 request to enable, clear or stop refused in its state'),
    ('ram', 'refused', '2 setpoints not followed: not enabled'),
    ('ram', 'change', 'plant.sensors.pressure_a.bias = 0 Pa'),
    ('ram', 'state', 'enabled: enabled by command'),
    ('ram', 'change', 'load.force = 25.07 N, then at every tick until t = 0.250000 s: 0 N'),
    ('supply', 'change', 'pressure_mpa = 19 MPa')]


@pytest.fixture(scope='module')
def result():
    with pytest.warns(TripWarning):
        return RIG.simulate(faults=[FAULT])


@pytest.fixture(scope='module')
def bag(result, tmp_path_factory):
    return result.save(tmp_path_factory.mktemp('events') / 'bag')


def test_a_result_has_all_that_happened_in_the_order_of_time(result):
    """The state at t = 0 is no event; the clear at 0.12 s is refused, its cause is there."""
    assert [(own.source, own.kind, own.what) for own in result.events] == HAPPENED
    times = [own.t_s for own in result.events]
    assert times == sorted(times)
    by_kind = dict(zip([own.what.partition(' ')[0] for own in result.events], times))
    assert times[1] == 0.03 and times[7] == 0.13 and times[9] == 0.201 and times[10] == 0.26
    assert times[5] == 0.121 and by_kind['2'] == 0.126
    assert 0.08 < times[2] == times[4] < 0.081 and 0.15 <= times[8] < 0.151


def test_a_bag_has_the_same_events_and_trips_as_the_result(bag, result):
    """Times in messages have 6 decimals, and numbers 9 digits; counts that of their command."""
    recorded = recorded_events(Bag(bag), RIG.configuration)
    assert [own[1:] for own in recorded] == HAPPENED
    again = isa_ros.read(bag)
    assert again.events == recorded
    for one, other in zip(again.trips, result.trips, strict=True):
        assert str(one) == str(other) and one.t_s == pytest.approx(other.t_s, abs=1e-6)
    exact = result.events
    for one, other in zip(recorded, exact, strict=True):
        assert one.t_s == pytest.approx(other.t_s, abs=1e-6)


def test_a_report_has_them_as_a_table_and_marks_the_trips_in_the_figure(bag, tmp_path):
    page, *_ = write_report(recorded(bag), tmp_path / 'report.html')
    text = page.read_text()
    assert '<h2>Events</h2><div class="scroll"><table>' in text
    assert '>load_cell_implausible, force that the pressures' in text
    assert '<li class="bad">Tripped: ram, load_cell_implausible, force that' in text
    trip, = (own for own in isa_ros.read(bag).events if own.kind == 'trip')
    assert f'<tr data-t="{trip.t_s:.9g}"><td>{trip.t_s:.6f}</td><td>ram</td><td>trip</td>' in text
    assert events_text(isa_ros.read(bag).events).startswith('t, s      of')


def test_a_run_without_events_says_so(tmp_path):
    rig = load('rig_linear', changes={'actuators.ram.auto_enable': False})
    silent = rig.simulate(0.01)
    bag = silent.save(tmp_path / 'bag')
    assert [own.what for own in isa_ros.read(bag).events] == ['disabled: initialised']
    assert events_text(silent.events).count('\n') == 1 and events_text([]) == ''


def test_a_table_of_very_many_events_is_cut():
    rows = event_rows([Event(0.1, 'ram', 'trip', 'overload')] * (MOST + 3))
    assert len(rows) == MOST + 2 and rows[-1][-1] == 'and 3 more'


class OutOfReach(Controller):
    """Asks one actuator for too much force at each tick, another for a place outside, twice."""

    def step(self, state):
        asked = {'kfe': Setpoint(position=0.05, effort=1e5)}
        if state.t_ns in (30_000_000, 31_000_000):
            asked['hfe'] = Setpoint(position=7.0)
        return asked


def test_requests_of_a_controller_that_are_refused_or_limited_are_told(tmp_path):
    """Once a second for each actuator; in memory, in the bag, and in what is read of it."""
    run = load('leg').replace({'actuators.kfe.beyond_range': 'limit'})
    with pytest.warns(UserWarning):
        result = run.simulate(0.04, [OutOfReach()])
    found = [own for own in result.events if own.what.startswith("a controller's request")]
    assert [(own.t_s, own.source, own.kind) for own in found] == [
        (0.001, 'kfe', 'warning'), (0.031, 'hfe', 'refused')]
    assert found[0].what.endswith('setpoint effort = 100000 N, limited to 7500 N, the rated force')
    assert found[1].what.startswith("a controller's request, setpoint position = 7 m, must be 0")
    bag = result.save(tmp_path / 'bag')
    assert isa_ros.read(bag).events == result.events
    assert replay(Bag(bag)).is_equal
