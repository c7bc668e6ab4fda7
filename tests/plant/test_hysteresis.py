"""Hysteresis and threshold of a valve: the loops of a data sheet, from the plays and the plant."""

from dataclasses import replace

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.sheet import actuator_record, ActuatorSheet, refuse_wiring
from isa_ros.core.conditions import BITS
from isa_ros.core.signals import COMMAND, HAS_MODE, HAS_REFERENCE
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.plant.hysteresis import (
    HYSTERESIS, hysteresis_record, magnetised, passed_of_sine, remember, widest_play)
from isa_ros.plant.valve_sheets import DataSheetValve, Valve
import numpy as np
import pytest
from tests.plant.test_plant import Body
from tests.sheets import actuator_sheet, override, smart_actuator

RATED = 0.010   # A
PERCENT = 0.01 * RATED


def sheet(hysteresis: float = 3.0, threshold: float = 0.5, reach: float = 20.0,
          model: str = 'isa_v5') -> Valve | DataSheetValve:
    """Return the sheet of a model's valve with hysteresis."""
    return replace(
        actuator_sheet(model).plant.valve, hysteresis_percent=hysteresis,
        threshold_percent=threshold, hysteresis_from_percent=reach)


def valve(*values: float) -> np.record:
    """Return the `HYSTERESIS` record of a `sheet` for 10 mA."""
    return hysteresis_record(sheet(*values), RATED)


def passed(currents: np.ndarray, own: np.record) -> np.ndarray:
    """Return what the valve makes of one current after another, in A."""
    out = np.zeros(len(currents))
    for k, current in enumerate(currents):
        out[k] = magnetised.py_func(current, own)
        remember.py_func(current, own)
    return out


def ramp(*ends: float, points: int = 200) -> np.ndarray:
    """Return currents in equal steps between ends that are in percent."""
    return PERCENT * np.concatenate(
        [np.linspace(a, b, points) for a, b in zip(ends, ends[1:])])


def width(amplitude: float, own: np.record) -> float:
    """Return the widest loop of an amplitude, in percent of the rated current."""
    n = 400
    currents = ramp(0.0, amplitude, -amplitude, amplitude, points=n)
    out = passed(currents, own)
    down, up = slice(n, 2 * n), slice(2 * n, 3 * n)
    # on common outputs: both branches rise with the current
    levels = np.linspace(max(out[down].min(), out[up].min()), min(out[down].max(), out[up].max()),
                         301)
    down_i = np.interp(levels, out[down][::-1], currents[down][::-1])
    up_i = np.interp(levels, out[up], currents[up])
    return float((up_i - down_i).max() / PERCENT)


@pytest.mark.parametrize(('amplitude', 'expected'), [(100.0, 3.0), (25.0, 3.0), (18.0, 3.0)])
def test_the_loop_is_as_wide_as_stated(amplitude, expected):
    """From 7/8 of hysteresis_from_percent and half the threshold on; interpolation is exact."""
    assert width(amplitude, valve()) == pytest.approx(expected, rel=1e-9)


def test_a_small_loop_is_hardly_wider_than_the_threshold():
    """0.85 % at 5 %, where a single play of 3 % has 3 %, and a pure threshold 0.5 %."""
    assert width(5.0, valve()) == pytest.approx(0.85, abs=0.02)
    assert width(5.0, valve(3.0, 3.0)) == pytest.approx(3.0, rel=1e-9)
    assert width(5.0, valve(0.5, 0.5)) == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize('turn', [100.0, 25.0, 0.0])
def test_after_a_reversal_nothing_moves_within_the_threshold(turn):
    own = valve()
    passed(ramp(0.0, 100.0, -100.0, turn), own)
    at = magnetised(turn * PERCENT, own)
    assert magnetised((turn - 0.499) * PERCENT, own) == at
    assert magnetised((turn - 0.501) * PERCENT, own) < at


def test_the_mean_of_both_branches_is_the_current():
    own = valve()
    passed(ramp(0.0, 100.0, -100.0), own)
    up = passed(ramp(-100.0, 0.0), own)[-1]
    passed(ramp(0.0, 100.0), own)
    down = passed(ramp(100.0, 0.0), own)[-1]
    assert up == pytest.approx(-down, rel=1e-12, abs=0.0)
    assert down - up == pytest.approx(3.0 * PERCENT, rel=1e-9, abs=0.0)


def test_a_minor_loop_closes_and_the_rate_does_not_matter():
    """Return-point memory, to the last bit; the same path in steps a quarter as large."""
    currents = ramp(0.0, 100.0, -20.0, 60.0, 10.0, 60.0)
    fine = np.interp(np.arange(0.0, len(currents) - 0.9, 0.25), np.arange(len(currents)), currents)
    own, slow = valve(), valve()
    out = passed(currents, own)
    assert out[599] == out[-1]      # both at 60 % after the turn at -20 %
    assert passed(fine, slow)[-1] == out[-1]
    assert own.plays == slow.plays


@pytest.mark.parametrize(('amplitude', 'lag'), [
    (0.2, 0.0), (1.0, 16.53), (5.0, 5.40), (40.0, 2.38)])
def test_the_first_harmonic_of_a_sine_is_that_of_the_plays(amplitude, lag):
    """V31 against a cycle of the plays; within the threshold nothing passes."""
    angles = 2.0 * np.pi * np.arange(-4000, 8000) / 4000    # three cycles, the last one counts
    out = passed(amplitude * PERCENT * np.sin(angles), valve())[-4000:]
    found = 2.0j * (out * np.exp(-1j * angles[-4000:])).mean() / (amplitude * PERCENT)
    expected = passed_of_sine(sheet(), amplitude)
    # sums over corners in steps of 1.6e-3 rad err by their squares
    assert found == pytest.approx(expected, abs=2.5e-6)
    assert -np.degrees(np.angle(expected)) == pytest.approx(lag, abs=0.01)


def test_both_directions_are_alike():
    """Odd to the last bit."""
    currents = ramp(0.0, 70.0, -30.0, 12.0)
    assert (passed(currents, valve()) == -passed(-currents, valve())).all()


def test_of_the_threshold_alone_is_one_play():
    """H = T: the weight of the four plays is 0, so that no bit of theirs is left."""
    own = valve(2.0, 2.0)
    currents, at = ramp(0.0, 70.0, -30.0, 12.0), 0.0
    for current, out in zip(currents, passed(currents, own)):
        at = min(max(at, current - own.half), current + own.half)
        assert out == at
    assert own.half == PERCENT


@pytest.mark.parametrize('current', [-0.01, -1e-4, 0.0, 3e-5, 2e-3])
def test_compiled_plays_equal_their_python_source(current):
    own, twin = valve(), valve()
    passed(ramp(0.0, 40.0, 3.0), own)
    twin.plays = own.plays
    assert magnetised(current, own) == magnetised.py_func(current, twin)
    remember(current, own)
    remember.py_func(current, twin)
    assert own.plays == twin.plays


@pytest.mark.parametrize(('values', 'message'), [
    ((0.2, 0.5, 20.0), 'hysteresis_percent = 0.2 %, must be >= threshold_percent = 0.5 %'),
    ((3.0, 0.5, 4.0), 'hysteresis_percent = 3 %, must be <= 2.5 %, threshold_percent and half of'),
    ((-1.0, 0.0, 20.0), 'hysteresis_percent = -1 %, must be >= 0 %'),
    ((21.0, 20.0, 20.0), 'hysteresis_percent = 21 %, must be <= 20 %'),
    ((3.0, -0.1, 20.0), 'threshold_percent = -0.1 %, must be >= 0 %'),
    ((3.0, 0.5, 0.5), 'hysteresis_from_percent = 0.5 %, must be >= 1 %')])
@pytest.mark.parametrize('model', ['isa_v5', 'smart_manifold', 'cylinder'])
def test_values_that_no_valve_has_are_refused(values, message, model):
    with pytest.raises(ParameterError, match=message):
        sheet(*values, model=model)


def test_the_hysteresis_of_a_pilot_is_refused():
    """A sheet's is that of the closed loop of the spool."""
    sheet = actuator_sheet('isa_v5', 'default', 'explicit')
    with pytest.raises(ConfigError, match='hysteresis_percent = 3 % and plant.spool.kind = pil'):
        refuse_wiring(override(sheet, 'plant.valve.hysteresis_percent', 3.0))


def with_hysteresis(model: str = 'cylinder', **values: float) -> ActuatorSheet:
    """Return a shipped sheet whose valve has a hysteresis of 3 % and a threshold of 0.5 %."""
    sheet = actuator_sheet(model)
    own = {'hysteresis_percent': 3.0, 'threshold_percent': 0.5} | values
    return replace(sheet, plant=replace(sheet.plant, valve=replace(sheet.plant.valve, **own)))


def settled(body: Body, percent: float) -> float:
    """Hold a current until the spool is at rest; return its place in percent of the stop."""
    body.current = percent * PERCENT
    # after 40 ms a spool of w_n = 628/s, zeta 0.8 has exp(-20) of its way left
    body.run(0.04)
    return float(body.row.plant.spool.position / 0.5e-3 * 100.0)


def test_the_spool_of_the_compiled_plant_has_the_loop():
    """Steps of the current and rest: nothing but the hysteresis is between both branches."""
    sheet, own = with_hysteresis(), valve()
    body = Body(sheet, 0.1)
    levels = [*np.linspace(0.0, 100.0, 5), *np.linspace(80.0, -100.0, 10),
              *np.linspace(-80.0, 80.0, 9)]
    expected = passed(PERCENT * np.array(levels), own) / PERCENT
    found = [settled(body, level) for level in levels]
    assert found == pytest.approx(expected, abs=1e-6)
    # at 0, 20, 40 and 60 % on the way down and up
    for level in (0.0, 20.0, 40.0, 60.0):
        down, up = (found[k] for k, own in enumerate(levels)
                    if round(own, 6) == level and k > 4)
        assert down - up == pytest.approx(3.0, abs=1e-5)


def test_a_coarse_step_finds_the_same_plays():
    """20 us against 1.25 us: the plays move with the current at each stage, not at the end."""
    coarse, fine = (Body(with_hysteresis(), 0.1) for _ in 'cf')
    for body, h in ((coarse, PLANT_STEP), (fine, PLANT_STEP / 16.0)):
        for level in (60.0, -30.0, 10.0):
            body.current = level * PERCENT
            body.run(1e-3, h)
    place = [body.row.plant.spool.position / 0.5e-3 for body in (coarse, fine)]
    assert place[0] == pytest.approx(place[1], abs=1e-6)
    assert abs(place[0]) > 1e-3


def test_a_valve_without_it_has_none():
    own = actuator_record(actuator_sheet('cylinder'), 0)['plant']['hysteresis'][0]
    assert own['is_on'] == 0.0 and own['share'] == 0.0
    assert HYSTERESIS.names[0] == 'is_on' and widest_play(valve()) == pytest.approx(
        1.5 * PERCENT, rel=1e-12, abs=0.0)


def commanded(actuator: SmartActuator, percent: float, ticks: int) -> None:
    """Command a current for a number of ticks."""
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['mode'] = HAS_REFERENCE | HAS_MODE, 1
    command['reference'] = percent * PERCENT
    actuator.accept(command)
    for _ in range(ticks):
        actuator.tick()


def test_a_state_saved_within_a_loop_goes_on_as_if_nothing_was():
    """And without its plays it would not."""
    def branch() -> SmartActuator:
        return smart_actuator('cylinder', 'blocked', sheet=with_hysteresis())
    one, other, third = branch(), branch(), branch()
    for level in (60.0, -40.0, 5.0):
        commanded(one, level, 30)
    other.restore(one.snapshot())
    third.restore(one.snapshot())
    third.memory.plays[:] = 0
    for own in (one, other, third):
        commanded(own, 8.0, 30)
    assert other.snapshot() == one.snapshot()
    assert third.snapshot() != one.snapshot()


def test_the_protection_knows_the_hysteresis_of_its_valve():
    """R15: at rest within the loop the spool is half of it away, and that is no deviation."""
    bit, found = BITS['spool_deviation'], []
    for values in ({}, {'hysteresis_percent': 0.0, 'threshold_percent': 0.0}):
        actuator = smart_actuator('cylinder', 'blocked', sheet=with_hysteresis(**values))
        for level in (60.0, 0.0):
            commanded(actuator, level, 400)
        x = actuator.memory.continuous['plant']['spool']['position'][0] / 0.5e-3
        found.append((x, actuator.memory.reu['protection']['values'][0, bit] / 0.5e-3))
    assert found[0][0] == pytest.approx(0.015, abs=1e-5)
    assert found[1][0] == pytest.approx(0.0, abs=1e-5)
    for _, deviation in found:      # what is left is a code of the spool sensor
        assert deviation == pytest.approx(0.0, abs=2.5 / 4096.0)


def test_wear_changes_it_during_a_run():
    """Both are `changeable`; the plays of the last tick are within the new ones."""
    actuator = smart_actuator('cylinder', 'blocked', sheet=with_hysteresis())
    commanded(actuator, 60.0, 200)
    actuator.tune({'plant.valve.hysteresis_percent': 8.0})
    commanded(actuator, 0.0, 400)
    x = actuator.memory.continuous['plant']['spool']['position'][0] / 0.5e-3
    assert x == pytest.approx(0.04, abs=1e-5)
