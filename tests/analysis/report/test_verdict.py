"""Verdict, limits, key figures and marks of runs whose signals are known."""

import isa_ros
from isa_ros.analysis.report.key_figures import (
    error_of, key_rows, landing_rows, landings, tracking_error)
from isa_ros.analysis.report.limits import reached_limits
from isa_ros.analysis.report.marks import Band, bands_of, marks_of, MOST
from isa_ros.analysis.report.verdict import BAD, GOOD, NOTE, verdict
from isa_ros.analysis.signals.signals import Signal, Signals, signals_of
from isa_ros.core.signals import SAMPLE
from isa_ros.run.events import Event, History
import numpy as np
import pytest

T = np.arange(101) * 0.01
RUN = isa_ros.load('rig_linear').configuration
SHEET = RUN.actuators[0].sheet


def signals(problem: str = '', **fields: np.ndarray) -> Signals:
    """Return signals of the ram, 1 s long."""
    return Signals(RUN, {f'ram.{name}': Signal(T, values) for name, values in fields.items()}, T,
                   'here', problem)


def texts(found, grade):
    return [own.text for own in found if own.grade == grade]


def test_a_quiet_run_is_good():
    found = verdict(signals(position=np.full(101, 0.04)), [], [], '')
    assert found[0] == (GOOD, 'The run came to its end, t = 1.000 s.')
    assert texts(found, GOOD)[1:] == [
        'Nothing tripped.', 'No loop, end stop or relief valve reached its limit.',
        'Did not move: ram.']
    assert not texts(found, NOTE) and not texts(found, BAD)


def test_samples_that_no_run_has_are_left_out_and_told():
    """Infinity and 1e308 of a damaged bag cannot be drawn; NaN is what was not measured."""
    places = np.full(101, 0.04)
    places[[3, 5, 7]] = np.inf, -1.7e308, np.nan
    own = signals(position=places, force=np.full(101, 2e3)).possible()
    assert own.impossible == ('ram.position',)
    assert np.flatnonzero(np.isnan(own['ram.position'])).tolist() == [3, 5, 7]
    assert own['ram.force'].tolist() == [2e3] * 101
    assert 'Not shown: samples beyond 1e+30 of ram.position.' in texts(
        verdict(own, [], [], ''), BAD)


def test_an_end_that_was_none_is_bad():
    found = verdict(signals(), [], [], 'The run ended by an error: lost.')
    assert found[0] == (BAD, 'The run ended by an error: lost.')


@pytest.mark.parametrize(('kind', 'grade', 'word'), [
    ('trip', BAD, 'Tripped'), ('warning', NOTE, 'Warned'), ('change', NOTE, 'Fault or change'),
    ('refused', NOTE, 'Not followed'), ('cavity', NOTE, 'Cavitated'),
    ('overpressure', BAD, 'Overpressure')])
def test_events_are_told_with_their_time(kind, grade, word):
    found = verdict(signals(), [Event(0.25, 'ram', kind, 'overload')] * 8, [], '')
    own = [text for text in texts(found, grade) if text.startswith(word)]
    assert own == [f'{word}: ram, overload, t = 0.250000 s.'] * 6 + [
        f'{word}: 2 more, see the events.']
    assert ('Nothing tripped.' in texts(found, GOOD)) is (kind != 'trip')


def test_what_settles_is_told_apart_from_what_moves():
    settles = verdict(signals(position=0.05 - 0.01 * np.exp(-T / 0.05)), [], [], '')
    assert [text for text in texts(settles, GOOD) if text.startswith('Settled')] == [
        'Settled: ram at t = 0.200 s.']
    moves = verdict(signals(position=0.04 + 0.01 * T), [], [], '')
    assert texts(moves, NOTE) == ['Still moving at the end: ram.']


def test_what_stands_is_not_said_to_move():
    """By less than a thousandth of the stroke; a sensor's last digits never settle."""
    stroke = SHEET.plant.drive.stroke
    for share, said in ((0.9e-3, 'Stood: ram within 0.09 mm.'),
                        (1.1e-3, 'Still moving at the end: ram.')):
        found = verdict(signals(position=0.04 + share * stroke * T), [], [], '')
        assert [own.text for own in found if 'ram' in own.text] == [said]
        assert (found[-1].grade == GOOD) is said.startswith('Stood')


def test_what_follows_a_motion_that_goes_on_is_not_blamed():
    """A reference that stands in the last tenth, or is not known, explains nothing."""
    wave = 0.04 + 0.01 * np.sin(2.0 * np.pi * 2.0 * T)

    def told(reference):
        return verdict(signals(position=wave, position_reference=reference), [], [], '')[-1]
    assert told(wave) == (GOOD, 'Moving at the end, as its reference: ram.')
    stands = np.where(T < 0.85, wave, 0.04)
    assert told(stands) == (NOTE, 'Still moving at the end: ram.')
    assert told(np.full(101, np.nan)).text == 'Still moving at the end: ram.'
    assert told(0.04 + 1e-4 * T).text == 'Still moving at the end: ram.'    # by 0.01 mm
    assert told(0.08 - wave).text == 'Still moving at the end: ram.'        # the other way


@pytest.mark.parametrize(('off', 'motion', 'follows'), [
    (0.0, 1.45, True), (0.0, 1.55, False), (0.0, 0.55, True), (0.0, 0.45, False),
    (0.0, -1.0, False), (0.0124, 1.0, True), (0.0127, 1.0, False)])
def test_an_early_step_does_not_make_another_motion_the_same(off, motion, follows):
    """A reference of 40 mm and then 10 mm more at 100 mm/s: by the motion and by the distance."""
    drift = 0.1 * np.maximum(T - 0.9, 0.0)
    wanted = np.where(T < 0.1, 0.02, 0.06) + drift
    position = np.where(T < 0.1, 0.02, 0.06) + off + motion * drift
    found = verdict(signals(position=position, position_reference=wanted), [], [], '')[-1]
    assert found.text.startswith('Moving at the end' if follows else 'Still moving')


@pytest.mark.parametrize(('span', 'position', 'said', 'grade'), [
    (0.9e-3, 1e-5, 'Stood: ram within 0.001 mm.', GOOD),
    (1.1e-3, 1e-5, 'Stood while its reference moved: ram within 0.001 mm.', NOTE),
    (1.1e-3, 0.0, 'Did not move while its reference moved: ram.', NOTE),
    (0.9e-3, 0.0, 'Did not move: ram.', GOOD)])
def test_what_stood_instead_of_moving_is_told(span, position, said, grade):
    """As a load that is too heavy for its stiffness; by the bound of standing."""
    stroke = SHEET.plant.drive.stroke
    own = signals(position=0.04 + position * stroke * T,
                  position_reference=0.04 + span * stroke * T)
    assert verdict(own, [], [], '')[-1] == (grade, said)
    off = verdict(own, [], [Band('ram', 0.0, 1.0, 'disabled')], '')[-1]
    assert 'reference' not in off.text      # which explains it
    fixed = load_blocked().configuration
    held = Signals(fixed, {name: own.over_time(name) for name in own}, T, 'here')
    assert 'reference' not in verdict(held, [], [], '')[-1].text    # so does a fixture


def load_blocked() -> isa_ros.Run:
    """Return the rig of the ram with its rod held."""
    return isa_ros.load('rig_linear', changes={'actuators.ram.load': {'kind': 'blocked'}})


def test_what_moves_or_stands_without_its_device_is_told():
    """A runaway is no motion that follows, and a load that holds itself none that is held."""
    wave, off = 0.04 + 0.01 * np.sin(2.0 * np.pi * 2.0 * T), [Band('ram', 0.0, 1.0, 'fault')]
    found = verdict(signals(position=wave, position_reference=wave), [], off, '')[-1]
    assert found == (NOTE, 'Still moving at the end: ram.')
    found = verdict(signals(position=0.04 + 1e-5 * T), [], off, '')[-1]
    assert found == (NOTE, 'Stood, its device fault at the end: ram within 0.01 mm.')


def test_what_came_to_rest_and_is_off_at_the_end_has_not_settled():
    """A device that was off before, or another one, does not count."""
    own = signals(position=0.05 - 0.01 * np.exp(-T / 0.05))

    def told(*bands):
        return {words.text: words.grade for words in verdict(own, [], bands, '')
                if 'ram at t' in words.text}
    on, off = Band('ram', 0.0, 0.3, 'enabled'), Band('ram', 0.3, 1.0, 'disabled')
    assert told(on, off) == {
        'Came to rest, its device disabled at the end: ram at t = 0.200 s.': NOTE}
    assert told(on, Band('ram', 0.3, 0.4, 'fault reaction'), Band('ram', 0.4, 1.0, 'fault')) == {
        'Came to rest, its device fault at the end: ram at t = 0.200 s.': NOTE}
    settled = {'Settled: ram at t = 0.200 s.': GOOD}
    assert told(Band('ram', 0.0, 0.5, 'disabled'), Band('ram', 0.5, 1.0, 'enabled'),
                Band('other', 0.0, 1.0, 'fault')) == told(on) == told() == settled


def test_of_another_version_no_limits_are_told():
    found = verdict(signals('unknown key', position=np.zeros(101)), [], [], '')
    assert [own.text for own in found] == [
        'The run came to its end, t = 1.000 s.', 'Nothing tripped.']


def test_limits_are_those_of_the_sheet():
    """From 0.2 s on 81 of 101 samples are at the limit; just below it none is."""
    stroke, late = SHEET.plant.drive.stroke, T >= 0.2 - 1e-9
    opening = SHEET.plant.relief.opening_pressure_mpa * 1e6
    limit = SHEET.reu.force.limit
    reached = {
        'position': np.where(late, stroke, 0.5 * stroke),
        'pressure_b': np.where(late, 1.001 * opening, 0.0),
        'spool_reference': np.where(late, -limit, 0.0)}
    found = reached_limits(signals(**reached))
    assert {own.what for own in found} == {
        'at the end stop where it is extended', 'relief valve of chamber B open',
        'output of the force loop at its limit'}
    assert all(own.t_s == pytest.approx(0.2) and own.share == pytest.approx(81 / 101)
               for own in found)
    assert str(found[0]).endswith(', first at t = 0.200 s, 80 % of the time')
    below = {'position': np.full(101, 0.99 * stroke), 'pressure_a': np.full(101, 0.999 * opening),
             'spool_reference': np.full(101, 0.999 * limit)}
    assert reached_limits(signals(**below)) == []
    retracted = reached_limits(signals(position=np.zeros(101)))
    assert [own.what for own in retracted] == ['at the end stop where it is retracted']


def test_an_error_is_that_of_the_samples():
    """A sine of 3 mm about the reference: rms 3/sqrt(2) over whole periods."""
    wave = 3e-3 * np.sin(2.0 * np.pi * 2.0 * T[:-1])
    found = error_of(signals(position=np.append(0.05 + wave, 0.05),
                             position_reference=np.full(101, 0.05)), 'ram', 'position')
    error = tracking_error(found)
    assert error.rms == pytest.approx(3e-3 / np.sqrt(2.0) * np.sqrt(100 / 101))
    # the sample nearest to the crest, 0.125 s
    assert error.most == pytest.approx(3e-3 * np.sin(np.pi * 0.48)) and error.t_s in T[[12, 13]]
    assert error_of(signals(position=wave), 'ram', 'position') is None


def test_the_row_of_an_actuator_has_its_figures():
    row = dict(zip(range(13), key_rows(signals(
        position=np.where(T < 0.5, 0.04, 0.052), velocity=-0.3 * (T == 0.5),
        force=np.where(T < 0.9, -1500.0, 700.0 + 10.0 * np.cos(np.pi * np.arange(101))),
        pressure_a=np.full(101, 5e6), pressure_b=np.full(101, 7.25e6),
        supply_volume=0.002 * T, force_reference=np.full(101, 700.0)))[1]))
    assert [row[k] for k in range(8)] == [
        'ram', '40.0', '52.0', 'mm', '300', '1500', 'N', '5.0 to 7.2']
    assert row[8] == '-' and row[9] == '2077, 2200 N'   # 2200 sqrt(90 / 101)
    assert (row[10], row[11], row[12]) == ('0.500', '10', '2.000')


def test_what_was_not_recorded_is_a_dash():
    row = key_rows(signals())[1]
    assert row[0] == 'ram' and set(row[1:3]) == {'-'} and set(row[7:]) == {'-'}


def test_ripple_is_half_of_peak_to_peak_in_the_last_tenth_of_the_time():
    """Not of the samples, of which a bag has fewer where nothing changed."""
    few = np.concatenate([T[:30], T[-40:]])
    force = np.where(np.arange(70) % 2, 4.0, 1.0)
    force[few < 0.93], force[few < 0.895] = 6.0, 9.0
    row = key_rows(Signals(RUN, {
        'ram.position': Signal(T, np.where(T < 0.5, 0.04, 0.05)),
        'ram.force': Signal(few, force)}, T, 'here'))[1]
    assert row[11] == '2.5'


def test_a_landing_is_the_first_contact_after_the_air():
    """A leg: 3, 4 N at 0.3 s give 5 N, its peak; a force of 1 N is no contact."""
    run = isa_ros.load('leg').configuration
    force = np.zeros((101, 3))
    force[10:20, 2] = 1.0
    force[30:60] = (0.0, 3.0, 4.0)
    force[40, 2] = 12.0
    found = Signals(run, {'body.foot_force': Signal(T, force)}, T, 'here')
    landing, = landings(found)
    assert (landing.t_s, landing.peak_t_s) == (T[30], T[40])
    assert landing.peak == pytest.approx(np.sqrt(153.0)) and landing.share == 30 / 101
    assert landing_rows(found)[1] == ('body.foot_force', '0.300', '12.37', '0.400', '30 %')
    assert landing_rows(Signals(run, {}, T, 'here')) == []
    down, = landings(Signals(run, {'body.foot_force': Signal(T, force + 9.0)}, T, 'here'))
    assert down.t_s is None


def test_states_are_bands_up_to_the_next_one():
    samples = np.zeros((4, 1), SAMPLE)
    samples['device_state'][:, 0] = (1, 1, 2, 5)
    samples['state_since'][:, 0] = (0.0, 0.0, 0.0123, 0.05)
    bands = bands_of(RUN, History([0, 5, 13, 51], samples), 0.2)
    assert [(own.state, own.begin_s, own.end_s) for own in bands] == [
        ('disabled', 0.0, 0.0123), ('enabled', 0.0123, 0.05), ('fault', 0.05, 0.2)]
    assert {own.source for own in bands} == {'ram'}


def test_marks_are_those_of_the_group_without_states():
    events = [Event(0.1, 'ram', 'trip', 'a'), Event(0.2, 'ram', 'state', 'b'),
              Event(0.3, 'other', 'trip', 'c'), *[Event(0.4, 'ram', 'warning', 'd')] * MOST]
    marks = marks_of(['ram'], [], events)
    assert len(marks.events) == MOST and {own.what for own in marks.events} == {'a', 'd'}


def test_a_real_run_has_the_same_figures_in_memory():
    result = isa_ros.load('rig_rotary', 'step').simulate(0.2)
    row = key_rows(signals_of(result))[1]
    assert float(row[5]) == pytest.approx(np.abs(result['rotor.force']).max(), rel=5e-3)
