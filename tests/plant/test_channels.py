"""The channels of the sensors: each error alone, at its size, and the delay line."""

from dataclasses import replace

from isa_ros.core.record import rows_of
from isa_ros.errors import ParameterError
from isa_ros.plant import channels
from isa_ros.plant.channels import (
    channel_errors, CHANNELS_STATE, disturb, enter, LINE, N_CHANNELS, NAMES, refuse_delays)
import numpy as np
import pytest
from tests.sheets import actuator_sheet

PERIOD = 5  # plant steps: 10 kHz
KEY = np.uint64(12345)
SHEET = actuator_sheet('isa_v5').plant.sensors


def errors(**changes):
    """Return the `CHANNEL_ERRORS` of channels, each given as the values that are not zero."""
    return channel_errors(SHEET.channels | {
        name: replace(getattr(SHEET, name), **values) for name, values in changes.items()})


def shown(own, n, first=1, state=None):
    """
    Return what is shown at ``n`` conversions, (n, N_CHANNELS).

    The exact value of channel k at conversion i is 1000 k + i.
    """
    state = rows_of(1, CHANNELS_STATE)[0] if state is None else state
    rows = np.empty((n, N_CHANNELS))
    for i in range(n):
        step = first + i * PERIOD
        enter(step, PERIOD, state)[:] = [1000.0 * k + i for k in range(N_CHANNELS)]
        disturb(step, PERIOD, KEY, own, state)
        rows[i] = state.shown
    return rows


EXACT = 1000.0 * np.arange(N_CHANNELS) + np.arange(300.0)[:, None]


def test_channels_are_ideal_by_default():
    assert errors().are_ideal
    assert not errors(force={'sigma': 1e-3}).are_ideal
    assert not errors(current={'stuck': 1.0}).are_ideal


@pytest.mark.parametrize('name', NAMES)
def test_a_bias_is_added_to_its_channel_alone(name):
    """S3."""
    apart = shown(errors(**{name: {'bias': 1e-3}}), 300) - EXACT
    assert (apart == np.where(np.array(NAMES) == name, (EXACT + 1e-3) - EXACT, 0.0)).all()


def test_a_drift_grows_from_the_first_conversion_on():
    """S3: at conversion i its age is i periods of 0.1 ms, whatever the first step is."""
    apart = shown(errors(force={'drift_per_s': 20.0}), 300, first=7)[:, 1] - EXACT[:, 1]
    # 1e-12: roundings of numbers of 1300
    assert apart == pytest.approx(20.0 * 1e-4 * np.arange(300), abs=1e-12)


@pytest.mark.parametrize('conversions', [1, 3, LINE - 1])
def test_a_delay_is_of_whole_conversions(conversions):
    """S3: until the line is full, the first value is read."""
    read = shown(errors(spool={'delay_ms': conversions * 0.1}), 300)
    age = np.minimum(np.arange(300), conversions)
    assert (read[:, 4] == EXACT[np.arange(300) - age, 4]).all()
    assert (read[:, :4] == EXACT[:, :4]).all() and (read[:, 5] == EXACT[:, 5]).all()


def test_a_stuck_channel_keeps_its_value():
    """From the beginning: the first one."""
    state = rows_of(1, CHANNELS_STATE)[0]
    own = errors(pressure_a={'bias': 1.0})
    before = shown(own, 10, state=state)
    after = shown(errors(pressure_a={'bias': 1.0, 'stuck': 1.0}), 10, 51, state)
    assert (after[:, 2] == before[-1, 2]).all()
    assert (after[:, 3] == EXACT[:10, 3]).all()
    assert (shown(errors(force={'stuck': 1.0}), 10)[:, 1] == EXACT[0, 1]).all()


def test_after_a_gap_line_and_drift_begin_again():
    """Ideal channels keep no line: an error that comes during a run begins with it."""
    state = rows_of(1, CHANNELS_STATE)[0]
    own = errors(force={'delay_ms': 0.5, 'drift_per_s': 1.0})
    shown(own, 20, state=state)
    later = shown(own, 20, 10_001, state)[:, 1]
    age = np.minimum(np.arange(20), 5)
    assert later == pytest.approx(
        EXACT[np.arange(20) - age, 1] + 1e-4 * np.arange(20), abs=1e-12)


def test_noise_has_its_own_numbers_in_every_channel():
    """S3; their statistics are those of `isa_ros.core.noise`."""
    noise = (shown(errors(**{name: {'sigma': 1e-5} for name in NAMES}), 300) - EXACT) / 1e-5
    assert noise.std(axis=0) == pytest.approx(np.ones(N_CHANNELS), abs=0.25)  # 6 std errors
    assert np.abs(np.corrcoef(noise.T) - np.eye(N_CHANNELS)).max() < 0.35


def test_compiled_channels_equal_their_python_source(monkeypatch):
    own = errors(
        position={'sigma': 1e-6, 'delay_ms': 0.3}, force={'sigma': 5.0, 'drift_per_s': 3.0},
        pressure_a={'sigma': 1e4, 'stuck': 1.0}, current={'bias': 1e-4})
    compiled = shown(own, 200)
    monkeypatch.setitem(globals(), 'enter', enter.py_func)
    monkeypatch.setitem(globals(), 'disturb', disturb.py_func)
    monkeypatch.setattr(channels, 'normal', channels.normal.py_func)
    assert shown(own, 200).tobytes() == compiled.tobytes()


@pytest.mark.parametrize(('delay_ms', 'refused'), [
    (0.15, 'must be <= 12.7 ms and a multiple of 0.1 ms'),
    (12.8, 'must be <= 12.7 ms and a multiple of 0.1 ms')])
def test_a_delay_that_the_line_cannot_have_is_refused(delay_ms, refused):
    force = replace(SHEET.force, delay_ms=delay_ms)
    with pytest.raises(
            ParameterError, match=rf'plant\.sensors\.force\.delay_ms = {delay_ms} ms, {refused}'):
        refuse_delays(SHEET.channels | {'force': force}, PERIOD)
    refuse_delays(SHEET.channels | {'force': replace(force, delay_ms=12.7)}, PERIOD)


def test_half_stuck_is_refused():
    with pytest.raises(ParameterError, match='stuck = 0.5, must be 0 or 1'):
        replace(SHEET.force, stuck=0.5)
