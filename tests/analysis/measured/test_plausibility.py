"""Units that are wrong are doubted in one line, and those of usual measurements are not."""

from pathlib import Path

import isa_ros
from isa_ros.actuator.setpoint_range import Bounds
from isa_ros.analysis.measured.against import against, NONE
from isa_ros.analysis.measured.fit import Fit
from isa_ros.analysis.measured.mapping import (
    MappedSignal, MeasurementMapping, SignalSource)
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.plausibility import (
    doubts_of_commands, doubts_of_fits, doubts_of_speed, doubts_of_time)
from isa_ros.analysis.signals.signals import Signal
import numpy as np
import pytest
from scripts.made_measurement import measured

DURATION = 1.0


def mapping(unit: str = 'N', scale: float = 1.0, rate: float | None = None,
            quantity: str = 'force') -> MeasurementMapping:
    own = MappedSignal(SignalSource('x', '', ''), unit, 1.0, 0.0, 0.0, '')
    return MeasurementMapping(
        'map.yaml', None, None if rate else 't', scale, rate, 0, 0.0, {quantity: own})


def over(t: np.ndarray, values: np.ndarray | None = None) -> Measurement:
    return Measurement('press.csv', {
        'force': Signal(t[:2], np.zeros(2)),
        'position': Signal(t, np.zeros(len(t)) if values is None else values)})


@pytest.mark.parametrize(('step', 'n', 'scale', 'expected'), [
    (1e-3, 4000, 1.0, ''), (1e-3, 101, 1.0, ''), (0.199, 40, 1.0, ''), (5.1e-5, 9000, 1.0, ''),
    (1e-6, 4000, 1e-3, '1000000 samples per second for 0.004 s: is its time in s?'),
    (1.0, 4000, 1.0, '1 samples per second for 3999 s: is its time in ms?'),
    (1e3, 4000, 1.0, '0.001 samples per second for 3999000 s: is its time in us?'),
    (2e-5, 500, 1e-3, '50000 samples per second for 0.00998 s: is its time in s?'),
    (4.9e-5, 9000, 1.0, '20408 samples per second for 0.441 s: is its time in another unit?'),
    (1e-4, 900, 1e-3, '10000 samples per second for 0.0899 s: is its time in s?'),
    (0.21, 99, 1.0, '4.76 samples per second for 20.6 s: is its time in ms?')])
def test_a_time_in_another_unit_is_doubted(
        step: float, n: int, scale: float, expected: str) -> None:
    """By rate and length; the unit is one by which the rate would be usual."""
    found = [*doubts_of_time(over(step * np.arange(n)), mapping(scale=scale))]
    assert found == ([f'press.csv: {expected}'] if expected else [])


def test_a_rate_of_the_mapping_is_doubted_and_the_clock_of_a_bag_is_not() -> None:
    t = 1e-6 * np.arange(4000)
    assert [*doubts_of_time(over(t), mapping(rate=1e6))][0].endswith('s: is rate_hz right?')
    assert not [*doubts_of_time(over(t), mapping()._replace(time=None))]
    assert not [*doubts_of_time(over(t[:1]), mapping())]


@pytest.mark.parametrize(('speed', 'expected'), [(2.9, ''), (3.1, '3.1 m/s')])
def test_a_speed_far_beyond_the_rated_one_is_doubted(speed: float, expected: str) -> None:
    """A sensor's outliers are no speed, nor is its noise: 1 mm between samples of 1 ms, 1 m/s."""
    t = np.arange(4000) * 1e-3
    x = speed / 4.0 * np.sin(4.0 * t) + 5e-4 * (-1.0) ** np.arange(4000)
    x[::2000] += 1.0
    found = [*doubts_of_speed(over(t, x), 9.0, 1.0, 'm/s')]
    assert bool(found) == bool(expected)
    assert not found or found == [
        'press.csv: the position moves at 3.1 m/s, the rated speed is 1 m/s: are the units of '
        'position and time right?']


def test_without_a_position_there_is_no_speed() -> None:
    t = np.arange(4000) * 1e-3
    assert not [*doubts_of_speed(Measurement('m', {'force': Signal(t, 9.0 * t)}), 9.0, 1.0, 'm/s')]
    assert not [*doubts_of_speed(over(t[:15], 9.0 * t[:15]), 9.0, 1.0, 'm/s')]
    assert [*doubts_of_speed(over(t[:30], 9.0 * t[:30]), 9.0, 1.0, 'm/s')]
    assert not [*doubts_of_speed(over(t[:30], 9.0 * t[:30]), 0.015, 1.0, 'm/s')]


def test_of_a_speed_only_what_is_compared_is_looked_at() -> None:
    """A time in us that is mapped as s lasts for weeks: the 10 ms of them fill no memory."""
    t = np.array([0.0, 1.0, 2e9])
    assert not [*doubts_of_speed(over(t, 0.1 * t), 600.0, 1.0, 'm/s')]
    assert [*doubts_of_speed(over(t, 5.0 * t), 600.0, 1.0, 'm/s')]


def test_a_speed_after_what_is_compared_is_not_doubted() -> None:
    t = np.arange(2000) * 1e-3
    own = over(t, 5.0 * np.maximum(t - 0.5, 0.0))
    assert not [*doubts_of_speed(own, 0.5, 1.0, 'm/s')]
    assert [*doubts_of_speed(own, 1.0, 1.0, 'm/s')]


@pytest.mark.parametrize('rate', [5.0, 2e4])
def test_a_logger_at_a_usual_rate_is_not_doubted(rate: float) -> None:
    """Its steps are some roundings off."""
    t = np.arange(4000) / rate
    for given in (mapping(rate=rate), mapping()):
        assert not [*doubts_of_time(over(t, t), given)]
        assert [*doubts_of_time(over(t * (1.2 if rate == 5.0 else 0.8), t), given)]


@pytest.mark.parametrize(('quantity', 'unit', 'gain', 'left', 'expected'), [
    ('force', 'N', 1000.0, 1400.0, 'kN, not N'), ('force', 'kN', 1e-3, 1.4e-3, 'N, not kN'),
    ('force', 'N', 1000.0, 1600.0, ''), ('force', 'N', 6.9, 0.1, ''),
    ('force', 'N', 0.15, 0.0, ''),
    ('pressure_a', 'bar', 11.0, 0.1, 'MPa, not bar'),
    ('pressure_a', 'psi', 16.0, 1.0, 'bar, not psi'),
    ('position', 'm', 0.0254, 1e-3, 'in, not m'),
    ('position', 'mm', 100.0, 1e-3, 'or scale another'),
    ('force', 'N', 340.0, 0.1, 'kN, not N'), ('force', 'N', 310.0, 0.1, 'or scale another'),
    ('force', 'N', -1000.0, 1.0, ''), ('force', 'N', 0.0, 0.0, '')])
def test_a_signal_many_times_as_large_is_doubted(
        quantity: str, unit: str, gain: float, left: float, expected: str) -> None:
    """Not where the courses differ: what is left is of the simulated signal."""
    own = mapping(unit, quantity=quantity)
    found = [*doubts_of_fits({quantity: Fit(9.0, 0.0, gain, left, 99)}, own, False)]
    assert len(found) == bool(expected)
    if expected:
        assert found == [f'map.yaml: signals.{quantity}: what is simulated is {gain:g} times '
                         f'what is measured: is its unit {expected}?']


def test_what_does_not_match_has_no_gain() -> None:
    fits = {'force': Fit(9.0, 0.25, 1e3, 1.0, 99, True), 'position': 'constant'}
    assert not [*doubts_of_fits(fits, mapping(), False)]
    assert [*doubts_of_fits({'force': Fit(9.0, 0.0, 1e3, 1.0, 99)}, mapping('Nm'), True)]


@pytest.mark.parametrize(('said', 'wrong', 'expected'), [
    ('unit: kN', 'unit: kN', ''), ('{column: t, unit: ms}', '{column: t, unit: us}', 'in ms?'),
    ('{column: pos, unit: mm, sign: -1, offset: 100.0}',
     '{column: pos, unit: mm, sign: -1, offset: 5050.0, scale: 100.0}', 'position moves at '),
    ('unit: kN', 'unit: N', 'is its unit kN, not N?')])
def test_a_wrong_unit_is_told_before_the_search(
        tmp_path: Path, said: str, wrong: str, expected: str) -> None:
    """After what is compared; of the same machine with the units of its log nothing is."""
    path, place = measured(tmp_path, DURATION, {}, clock_ppm=0.0)
    place.write_text(place.read_text().replace(said, wrong).replace(
        'signals:', 'signals:\n  velocity_command: {from: position_command}'))
    told: list[str] = []
    against(path, place, isa_ros.load('rig_linear'), [NONE], begun=told.append)
    assert told[0].startswith('press.csv: 1001 samples') and bool(told[1:]) == bool(expected)
    assert any(expected in line for line in told)


@pytest.mark.parametrize(('share', 'field', 'expected'), [
    (0.4, 'position', False), (0.6, 'position', True), (1.0, 'effort', False)])
def test_a_command_that_is_mostly_beyond_its_range_is_doubted(
        share: float, field: str, expected: bool) -> None:
    """As one in mm that is mapped as m; a press may be commanded against its stop."""
    t = np.arange(100) * 1e-2
    values = np.where(np.arange(100) < 100 * share, 50.0, 0.05)
    for sign in (1.0, -1.0):
        found = [*doubts_of_commands(
            Measurement('m', {'position_command': Signal(t, sign * values)}),
            {field: Bounds(-0.1, 0.1, 'm', 'the stroke')})]
        assert bool(found) == expected
    assert not expected or found == [
        'm: 60 % of position_command are beyond -0.1 to 0.1 m, the stroke: is its unit right?']


@pytest.mark.parametrize(('scale', 'expected'), [
    (1.0, ''), (1 / 29, ''), (1e-3, '1000'), (0.0, '')])
def test_a_command_that_hardly_moves_is_doubted(scale: float, expected: str) -> None:
    """As one in mm that is mapped as um; one at rest is not: the load may be pushed."""
    t = np.arange(100) * 1e-2
    x = 0.02 * np.sin(t)
    found = [*doubts_of_commands(Measurement('m', {
        'position': Signal(t, x), 'position_command': Signal(t, scale * x)}), {})]
    assert found == ([f'm: the position moves {expected} times as far as position_command: are '
                      'both units right?'] if expected else [])
