"""What the devices of a run did by themselves: a line for each, in memory, live, and printed."""

from isa_ros.core.conditions import BITS
from isa_ros.core.device import ENABLED, FAULT
from isa_ros.core.signals import SAMPLE
from isa_ros.scripting.run import load
from isa_ros.testing import assert_no_trips
from isa_ros.tick.trips import counts_of, Trip, TripLog, Tripped, trips_of, TripWarning
import numpy as np
import pytest

RIG = load('rig_linear', duration=0.2)
LOST = {'t_s': 0.03, 'actuator': 'ram', 'set': {'plant.sensors.pressure_a.bias': -1e8}}
NAMES = [('ram', False), ('wheel', True)]


def sample(trips=(), last='', t=0.0, state=ENABLED, **fields):
    """Return the `SAMPLE` of one actuator at one instant."""
    row = np.zeros(1, SAMPLE)
    row['trips'] = sum(1 << BITS[name] for name in trips)
    row['last_trip'] = 1 << BITS[last] if last else 0
    row['trip_time'], row['device_state'] = t, state
    for name, value in fields.items():
        row[name] = value
    return row


def log(*instants):
    """Return the log of a ram and a wheel, (n, 2), of which only the wheel trips."""
    return np.array([np.concatenate([sample(), own]) for own in instants])


@pytest.fixture(scope='module')
def result():
    with pytest.warns(TripWarning, match='ram: load_cell_implausible tripped') as caught:
        found = RIG.simulate(faults=[LOST])
    assert len(caught) == 1 and caught[0].filename == __file__
    return found


def test_a_run_in_which_a_condition_trips_warns_and_lists_it(result):
    """50 ms of delay after the fault, at a conversion; the level is that of docs/protection.md."""
    trip, = result.trips
    assert (trip.actuator, trip.condition, trip.state) == ('ram', 'load_cell_implausible', 'fault')
    assert 0.08 < trip.t_s < 0.081 and trip.level == 1000.0 < trip.value
    assert str(trip) == (
        f'ram: load_cell_implausible tripped at t = {trip.t_s:.6f} s, force that the pressures '
        f'do not explain {trip.value:.4g} N > 1000 N: fault')


def test_a_run_in_which_none_trips_is_silent(recwarn):
    assert RIG.simulate(0.05).trips == []
    assert not [one for one in recwarn if issubclass(one.category, TripWarning)]


def test_a_users_test_asserts_that_none_tripped_in_a_result_or_a_bag(result, tmp_path):
    bag = result.save(tmp_path / 'bag')
    for run, line in ((result, 'ram: load_cell_implausible tripped at t = 0.08'),
                      (bag, 'ram: load_cell_implausible tripped at t = 0.08'),
                      (str(bag), 'ram: load_cell_implausible tripped')):
        with pytest.raises(AssertionError, match=line):
            assert_no_trips(run)
    assert_no_trips(RIG.simulate(0.02))


def test_a_trip_that_came_and_went_within_a_tick_is_found_and_others_of_its_tick_are_named():
    found = trips_of(log(
        sample(), sample((), 'overspeed', 0.1, trip_value=60.0, trip_level=50.0),
        sample(('overload', 'overcurrent'), 'overcurrent', 0.2, FAULT, trip_value=2.0,
               trip_level=1.5),
        sample(('overload', 'overcurrent'), 'overcurrent', 0.2, FAULT),
        sample((), 'overcurrent', 0.2)), NAMES)
    assert found == [
        Trip('wheel', 'overspeed', 0.1, 60.0, 50.0, 'rad/s', 'enabled'),
        Trip('wheel', 'overload', 0.2, None, None, 'Nm', 'fault'),
        Trip('wheel', 'overcurrent', 0.2, 2.0, 1.5, 'A', 'fault')]
    assert str(found[0]) == (
        'wheel: overspeed tripped at t = 0.100000 s, estimated speed 60 rad/s > 50 rad/s: enabled')
    assert str(found[1]) == 'wheel: overload tripped at t = 0.200000 s: fault'


def test_a_trip_that_lasts_while_another_trips_is_told_once():
    lasting, both = ('overload',), ('overload', 'overcurrent')
    found = trips_of(log(
        sample(), sample(lasting, 'overload', 0.1), sample(both, 'overcurrent', 0.2),
        sample((), 'overcurrent', 0.2), sample(lasting, 'overload', 0.3)), NAMES)
    assert [(trip.condition, trip.t_s) for trip in found] == [
        ('overload', 0.1), ('overcurrent', 0.2), ('overload', 0.3)]


def test_a_condition_below_its_level_is_told_so_and_one_that_comes_again_has_one_line():
    instants = [sample((), 'supply_low', t, trip_value=4e6, trip_level=5e6)
                for t in (0.1, 0.2, 0.3)]
    tripped = Tripped()
    assert not tripped
    tripped.add(trips_of(log(sample(), *instants), NAMES))
    assert tripped and tripped.lines() == [
        'wheel: supply_low tripped at t = 0.100000 s, supply pressure 4000000 Pa < 5000000 Pa: '
        'enabled, 3 times until t = 0.300000 s']


def test_what_has_tripped_before_the_first_rows_is_not_new():
    first = sample(('overload',), 'overload', 0.1)
    assert trips_of(log(first, first), NAMES) == []


class _Rows:
    def __init__(self, samples):
        self.samples = samples


def test_a_live_run_keeps_its_lines_over_a_reset_and_tells_commands_without_effect_at_its_end():
    rows, trips = _Rows(log(sample())[0].copy()), TripLog(NAMES)
    for _ in range(2):
        rows.samples[:] = log(sample())[0]
        trips.take(0, rows)
        rows.samples[:] = log(sample(
            ('overload',), 'overload', 0.1, unused_setpoints=2.0, refused_requests=1.0))[0]
        trips.take(1, rows)
        trips.end()
    counts = ['wheel: 2 setpoints not followed: not enabled',
              'wheel: 1 request to enable, clear or stop refused in its state']
    assert trips.lines() == [
        'wheel: overload tripped at t = 0.100000 s, measured force 0 Nm > 0 Nm: enabled, 2 times '
        'until t = 0.100000 s', *counts, *counts]
    assert list(counts_of(['ram'], sample(unused_setpoints=1.0))) == [
        'ram: 1 setpoint not followed: not enabled']


def test_a_trip_without_a_quantity_is_told_without_one():
    """That of a bag which names it by bits alone."""
    trip, = trips_of(log(sample(), sample(
        ('overload',), 'overload', 0.1, trip_value=np.nan, trip_level=1.0)), NAMES)
    assert trip.value is trip.level is None
    assert str(trip) == 'wheel: overload tripped at t = 0.100000 s: enabled'


def test_what_lasts_since_before_the_first_rows_is_not_told_with_the_next_trip():
    found = trips_of(log(
        sample(('overload',), 'overload', 0.1),
        sample(('overload', 'overcurrent'), 'overcurrent', 0.2)), NAMES)
    assert [trip.condition for trip in found] == ['overcurrent']
