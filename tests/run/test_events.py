"""Events in samples: cavities, counts and changes, each once."""

from collections.abc import Sequence
from typing import Any

import isa_ros
from isa_ros.analysis.report.events import recorded_events
from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.changeable import Changeable
from isa_ros.core.conditions import BITS
from isa_ros.core.signals import SAMPLE
from isa_ros.run.events import (
    _runs, CHANGE, events_in, History, OVERPRESSURE, page_event, SMALL, Trapped)
from isa_ros.run.recorded import _last_trip
from msg_adapters import device
import numpy as np
import pytest

RUN = load_run(find('rig_linear.yaml', CONFIG))


def samples(n: int, **fields) -> np.ndarray:
    """Return n `SAMPLE` rows of the rig's actuator with columns."""
    rows = np.zeros((n, 1), SAMPLE)
    for name, values in fields.items():
        rows[name][:, 0] = values
    return rows


def happened(history: History) -> list[tuple]:
    return [tuple(own) for own in events_in(RUN, history)]


def test_the_largest_cavity_is_one_event_at_its_first_sample():
    cavity = [0.0, SMALL, 2e-7, 3e-7, 3e-7]
    assert happened(History([0, 2, 4, 6, 8], samples(5, largest_cavity=cavity))) == [
        (0.004, 'ram', 'cavity', 'vapour in a chamber, at most 0.3 ml')]
    assert happened(History(range(5), samples(5, largest_cavity=SMALL))) == []


def test_each_count_is_one_event_from_its_first_sample_on():
    history = History(range(4), samples(
        4, unused_setpoints=[0, 0, 1, 7], refused_requests=[0, 2, 2, 2]))
    assert happened(history) == [
        (0.001, 'ram', 'refused', '2 requests to enable, clear or stop refused in its state'),
        (0.002, 'ram', 'refused', '7 setpoints not followed: not enabled')]


def test_a_value_that_changes_at_every_tick_is_one_event_and_has_the_units_of_its_key():
    """A change in sample k took effect at tick k - 1; at t = 0 there is no tick before."""
    forces = {0: 5.0, 1: 10.0, 2: 20.0, 4: 20.5, 9: 0.0}
    history = History([], samples(0), {tick: {0: {'load.force': value}}
                                       for tick, value in forces.items()},
                      {3: {'supply.pressure_mpa': 12.5}})
    assert happened(history) == [
        (0.0, 'ram', 'change', 'load.force = 10 N, then at every tick until t = 0.003000 s: '
         '20.5 N'),
        (0.002, 'supply', 'change', 'pressure_mpa = 12.5 MPa'),
        (0.008, 'ram', 'change', 'load.force = 0 N')]
    gain = History([], samples(0), {1: {0: {'link.delay_cycles': 2.0, 'force.kp': 3e-7}}})
    assert happened(gain) == [(0.0, 'ram', 'change', 'link.delay_cycles = 2 cycles'),
                              (0.0, 'ram', 'change', 'reu.force.kp = 3e-07 m/N')]


def test_a_value_is_in_the_unit_of_its_key():
    own = Changeable('current.kp', 1e3, {'unit': 'V/A', 'bounds': {}, 'doc': ''},
                     'reu.current.kp_v_per_ma', 1e3, 'V/mA')
    found, = _runs('ram', 'current.kp', {1: 3000.0}, own, 1_000_000)
    assert found.what == 'reu.current.kp_v_per_ma = 3 V/mA'


def test_a_reaction_is_told_by_its_name():
    """It was the place of its name in the table of reactions."""
    result = isa_ros.load('rig_linear').simulate(0.01, faults=[
        {'t_s': 0.004, 'actuator': 'ram', 'set': {'reu.protection.overload.reaction': 'warn'}}])
    assert 'reu.protection.overload.reaction = warn' in [own.what for own in result.events]


def test_a_warning_that_is_there_already_is_not_new():
    """The second sample has one more, the third the same without the first."""
    overload, overspeed = (1 << BITS[name] for name in ('overload', 'overspeed'))
    history = History(range(4), samples(
        4, warnings=[0, overload, overload | overspeed, overspeed], state_since=[0, 1, 2, 3]))
    assert happened(history) == [(1.0, 'ram', 'warning', 'overload'),
                                 (2.0, 'ram', 'warning', 'overspeed')]


def test_a_warning_is_that_of_the_sample_which_is_the_first_to_have_it():
    overload = 1 << BITS['overload']
    history = History(range(4), samples(
        4, warnings=[0, 0, overload, overload], state_since=[0, 0, 2, 2]))
    assert happened(history) == [(2.0, 'ram', 'warning', 'overload')]


def test_a_trip_without_a_time_is_that_of_the_message_that_is_the_first_to_name_it():
    before = samples(1, trips=4, last_trip=4, trip_time=0.5)[0, 0]
    kept = _last_trip(before, {'trips': 4.0, 'state_since': 0.75})
    assert (kept['last_trip'], kept['trip_time']) == (4.0, 0.5)
    new = _last_trip(before, {'trips': 6.0, 'state_since': 0.75})
    assert (new['last_trip'], new['trip_time']) == (2.0, 0.75) and np.isnan(new['trip_value'])


def test_the_fields_of_a_status_are_those_it_was_made_of():
    """Bits, names and numbers; what a state says in words is its event, of a fault the trip."""
    given = {
        'device_state': 2, 'device_mode': 6, 'device_event': 5, 'warnings': 0b10010, 'trips': 4,
        'state_since': 1.25, 'first_trip': 4, 'last_trip': 8, 'trip_time': 1.125,
        'trip_value': -2.5, 'trip_level': 3.5, 'warning_time': 0.75, 'unused_setpoints': 3,
        'refused_requests': 2, 'age': 0.25, 'is_stale': 1, 'frames_lost_down': 5,
        'frames_lost_up': 6, 'commands_dropped': 7}
    values = {own.key: own.value for own in device.status('ram', given).values}
    assert device.sample_fields(values) == given
    with pytest.raises(ValueError, match="condition 'moon' is unknown"):
        device.bits_of('overload, moon')
    assert device.bits_of('') == 0.0


def press(*pressures: float, ticks: Sequence[int] = (0, 2, 4)) -> list[tuple[Any, ...]]:
    """Return the events of the press, rated at 16 MPa, with these pressures behind a spear."""
    run = isa_ros.load('press').configuration
    history = History([], samples(0), cushions={
        0: Trapped(ticks, np.array(pressures) * 1e6)})
    return [tuple(own) for own in events_in(run, history)]


def test_a_cushion_beyond_the_proof_pressure_is_told_of():
    """1.5 times the rated 16 MPa; once, from when on and how much at most."""
    assert press(0.0, 24.01, 76.04) == [(
        0.002, 'slide', 'overpressure', 'behind the spear of a cushion, at most 76.04 MPa, more '
        'than 24 MPa, 1.5 times plant.drive.rated_pressure_mpa')]
    assert press(0.0, 23.99, -0.1) == [] == press(ticks=())


def test_a_run_and_its_bag_tell_of_the_same_overpressure(tmp_path):
    """The slide meets its cushion with all that the valve brings."""
    result = isa_ros.load('press', 'press_stroke', duration=0.8).simulate()
    own, = (one for one in result.events if one.kind == OVERPRESSURE)
    most = result['slide.cushion_pressure'].max()
    assert f'at most {most / 1e6:.4g} MPa' in own.what and 43e6 < most < 44e6
    first = result.time[np.argmax(result['slide.cushion_pressure'] > 24e6)]
    assert (own.t_s, own.source) == (pytest.approx(float(first), abs=1e-9), 'slide')
    bag = result.save(tmp_path / 'bag')
    assert own in isa_ros.read(bag).events and own in recorded_events(
        Bag(bag), result.scenario.run)


def test_a_bag_with_some_samples_of_a_cushion_tells_of_those(tmp_path):
    """Decimated to every 50th tick, the peak is missed and the rest is not."""
    run = isa_ros.load('press', 'press_stroke', changes={'record': {
        'decimate': {'/*/cushion_pressure': 50}}}, duration=0.8)
    bag = run.simulate().save(tmp_path / 'bag')
    own, = (one for one in isa_ros.read(bag).events if one.kind == OVERPRESSURE)
    assert own.t_s == pytest.approx(0.7, abs=1e-9)
    assert own in recorded_events(Bag(bag), run.configuration)


def test_a_setpoint_of_a_page_is_of_the_tick_that_it_took_effect_at():
    """Its line comes when the slider has stood still; those of older bags have no tick."""
    history = History([], samples(0), events={
        9: [page_event('ram: position = 0.03', 4), 'paused'],
        20: ['by the page, ram: effort = 7']})
    assert [(own.t_s, own.source, own.kind, own.what) for own in events_in(RUN, history)] == [
        (0.004, 'ram', CHANGE, 'by the page, position = 0.03'),
        (0.02, 'ram', CHANGE, 'by the page, effort = 7')]
