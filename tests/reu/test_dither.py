"""Dither: a square wave of the current at conversions, where the outputs are on."""

from dataclasses import replace

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_MODE, HAS_REFERENCE
from isa_ros.errors import ParameterError
from isa_ros.reu.dither import dither, HeldWithDither
from isa_ros.reu.wiring import Held, KINDS
import numpy as np
import pytest
from tests.sheets import actuator_sheet, smart_actuator

RATED = 0.010   # A, of the model cylinder


def current(**values: float) -> HeldWithDither:
    """Return a current block of 10 kHz."""
    return HeldWithDither(**{'rate_hz': 1e4, 'dither_percent': 2.0, 'dither_hz': 250.0} | values)


def dithered(model: str = 'cylinder', variants: tuple[str, ...] = (),
             **values: float) -> ActuatorSheet:
    """Return a sheet with a dither of 2 % at 250 Hz."""
    sheet = actuator_sheet(model, 'default', *variants)
    own = {'dither_percent': 2.0, 'dither_hz': 250.0} | values
    return replace(sheet, reu=replace(sheet.reu, current=replace(sheet.reu.current, **own)))


def run(actuator: SmartActuator, ticks: int, enable: float = 1.0) -> tuple[np.ndarray, ...]:
    """Command 1 mA; return drive and reference of the current after each tick, in A."""
    command = np.zeros(1, COMMAND)[0]
    command['kinds'] = HAS_REFERENCE | HAS_MODE | HAS_ENABLE
    command['mode'], command['reference'], command['is_enabled'] = 1, 1e-3, int(enable)
    actuator.accept(command)
    found = np.zeros((ticks, 2))
    for k in range(ticks):
        actuator.tick()
        reu = actuator.memory.reu[0]
        found[k] = reu['drive'], reu['current_reference']
    return found[:, 0], found[:, 1]


@pytest.mark.parametrize(('rate', 'hz', 'half'), [
    (1e4, 250.0, 20), (1e4, 416.0, 12), (1e4, 416.7, 12), (1e4, 5000.0, 1), (5e4, 333.0, 75),
    (1e4, 1e-3, 5_000_000)])
def test_half_of_its_period_is_whole_conversions(rate, hz, half):
    """416 Hz is 5000/12 with three digits."""
    assert current(rate_hz=rate, dither_hz=hz).half_period == half


@pytest.mark.parametrize(('values', 'message'), [
    ({'dither_hz': 3000.0}, 'dither_hz = 3000 Hz, half of its period must be a whole number of '
                            'periods of rate_hz = 10000 Hz, such as 1667 or 2500 or 5000 Hz'),
    ({'dither_hz': 9000.0}, 'dither_hz = 9000 Hz, half of its period must be a whole'),
    ({'dither_hz': 0.0}, 'dither_percent = 2 %, must be 0 % with dither_hz = 0 Hz'),
    ({'dither_hz': 1e-60}, 'dither_hz = 1e-60 Hz, must be 0 Hz or >= 0.001 Hz'),
    ({'dither_hz': 9.9e-4, 'dither_percent': 0.0}, 'dither_hz = 0.00099 Hz, must be 0 Hz or >='),
    ({'dither_percent': 21.0}, 'dither_percent = 21 %, must be <= 20 %'),
    ({'dither_percent': -1.0}, 'dither_percent = -1 %, must be >= 0 %')])
def test_a_dither_that_the_conversions_do_not_resolve_is_refused(values, message):
    with pytest.raises(ParameterError, match=message):
        current(**values)


def test_none_is_asked_of_a_block_without_dither():
    assert current(dither_percent=0.0, dither_hz=3000.0).half_period >= 1
    assert KINDS[HeldWithDither] == KINDS[Held]


@pytest.mark.parametrize('step', [6, 7, 25, 26, 46, 1006])
def test_it_begins_upwards_and_is_compiled_as_it_is_written(step):
    """R20: k_0 = 6, n = 20 plant steps."""
    expected = 1e-4 if (step - 6) % 40 < 20 else -1e-4
    assert dither(step, 6, 20, 1e-4) == dither.py_func(step, 6, 20, 1e-4) == expected


def test_the_drive_is_the_reference_and_a_square_wave():
    """2 % of 10 mA at 250 Hz: 20 conversions up, 20 down, around the 1 mA that is recorded."""
    drive, reference = run(smart_actuator('cylinder', 'blocked', sheet=dithered()), 400)
    wave = (drive - reference)[100:]
    assert np.abs(wave) == pytest.approx(0.02 * RATED, rel=1e-9, abs=0.0)
    assert reference[100:] == pytest.approx(1e-3, rel=1e-9, abs=0.0)
    turns = np.flatnonzero(np.diff(np.sign(wave)))
    assert set(np.diff(turns)) == {20}
    assert wave[:40].sum() == pytest.approx(0.0, abs=1e-15)


def test_outputs_that_are_off_have_none():
    actuator = smart_actuator('cylinder', 'blocked', sheet=dithered())
    run(actuator, 100)
    drive, reference = run(actuator, 300, enable=0.0)
    assert not drive[-50:].any() and not reference[-50:].any()


def test_it_frees_a_valve_of_its_hysteresis():
    """A play of 1 % is gone with a dither of twice its half; without, the spool stays beside."""
    places = []
    for percent in (0.0, 2.0):
        sheet = dithered(dither_percent=percent)
        own = replace(sheet.plant.valve, hysteresis_percent=1.0, threshold_percent=1.0)
        actuator = smart_actuator('cylinder', 'blocked', sheet=replace(
            sheet, plant=replace(sheet.plant, valve=own)))
        run(actuator, 600)
        x = np.zeros(400)
        for k in range(400):
            actuator.tick()
            x[k] = actuator.memory.continuous['plant']['spool']['position'][0] / 0.5e-3
        places.append(x.mean())
    # 1 mA from null is 10 %, less half of the play
    assert places[0] == pytest.approx(0.095, abs=1e-5)
    # of the square wave the spool keeps a share; the mean of both its ends is the current's
    assert places[1] == pytest.approx(0.1, abs=2e-4)
