"""The events of a report: what the messages of the devices of a bag show."""

from isa_ros.analysis.report.events import (
    DeviceEvent, event_rows, events_text, MOST, recorded_events, trips)
from isa_ros.analysis.report.report import write_report
from isa_ros.bag.reader import Bag
from isa_ros.scripting.run import load
from isa_ros.tick.trips import TripWarning
import pytest

RIG = load('rig_linear', {'name': 'short', 'duration_s': 0.2, 'tracks': {'ram': [
    {'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.12, 'clear_fault': True},
    {'t_s': 0.15, 'clear_fault': True, 'enabled': True}]}})
FAULT = {'t_s': 0.03, 'actuator': 'ram', 'until_s': 0.13,
         'set': {'plant.sensors.pressure_a.bias': -1e8}}


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    with pytest.warns(TripWarning):
        result = RIG.simulate(faults=[FAULT])
    return result.save(tmp_path_factory.mktemp('events') / 'bag')


def test_trips_warnings_and_states_are_in_their_order(bag):
    """The state at t = 0 is no event; the clear at 0.12 s is refused, its cause is there."""
    found = recorded_events(Bag(bag))
    assert [(own.kind, own.what) for own in found] == [
        ('state', 'enabled: initialised'),
        ('trip', 'load cell implausible'), ('warning', 'load cell implausible'),
        ('state', 'fault: load cell implausible'), ('state', 'enabled: enabled by command')]
    assert [own.t_s for own in trips(found)] == [found[3].t_s]
    assert 0.08 < found[3].t_s < 0.081 and 0.15 <= found[4].t_s < 0.151


def test_a_report_has_them_as_a_table_and_marks_the_trips_in_the_figure(bag, tmp_path):
    page, *_ = write_report(bag, tmp_path / 'report.html')
    text = page.read_text()
    assert '<h2>Events</h2><table>' in text and '<td>load cell implausible</td>' in text
    assert events_text(Bag(bag)).splitlines()[0].split() == ['t,', 's', 'actuator', 'what']


def test_a_run_without_events_says_so(tmp_path):
    result = RIG.replace({'scenario.tracks.ram': [{'t_s': 0.0, 'position': 'hold'}]})
    silent = result.replace({'actuators.ram.auto_enable': False}).simulate(0.01)
    bag = silent.save(tmp_path / 'bag')
    assert [own.what for own in recorded_events(Bag(bag))] == ['disabled: initialised']
    assert events_text(Bag(bag)).count('\n') == 1


def test_a_table_of_very_many_events_is_cut():
    rows = event_rows([DeviceEvent(0.1, 'ram', 'trip', 'overload')] * (MOST + 3))
    assert len(rows) == MOST + 2 and rows[-1][-1] == 'and 3 more'
