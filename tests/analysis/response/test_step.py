"""The step of one loop, from its trace."""

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.analysis.response.choice import Choice
from isa_ros.analysis.response.loops import Loop, UserUnit
from isa_ros.analysis.response.rig import rig
from isa_ros.analysis.response.step import evaluate, step, StepResponse, summary
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.sheets import actuator_sheet

RATE, BEFORE, RISES = 1000.0, 20, 10


def loop(sheet: ActuatorSheet) -> Loop:
    """Return a loop of a position."""
    metre = UserUnit('m')
    return Loop(name='position', label='position', sheet=sheet, unit=metre, inward=None,
                inward_unit=metre, quantity='position', per_reference=1.0, rate_hz=RATE,
                amplitude=0.01, largest=0.1)


@pytest.mark.parametrize('start', [0.0, 0.05, -0.03])
def test_figures_count_from_where_the_step_begins(start: float) -> None:
    """A ramp of 10 ms of 10 mm, from any place: 8 ms from 10 to 90 %, no overshoot or error."""
    ramp = np.clip((np.arange(220) - BEFORE) / RISES, 0.0, 1.0)
    output = start + 0.01 * ramp
    trace = {'position': output, 'position_reference': np.where(ramp > 0.0, start + 0.01, start)}
    found = evaluate(loop(actuator_sheet('isa_v5')), trace, BEFORE, start, 0.01, RATE)
    assert found.t[BEFORE] == 0.0 and found.inward is None
    # the ramp's crossings interpolate differences of numbers of 0.06 m
    assert found.figures.rise_time == pytest.approx(8e-3, rel=1e-9)
    assert found.figures.overshoot == pytest.approx(0.0, abs=1e-12)
    assert found.figures.steady_error == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(('off', 'amplitude', 'told'), [
    (0.0004, 0.01, ''), (0.0006, 0.01, '0.0006 m short of'), (0.006, -0.01, '0.006 m beyond'),
    (-0.03, 0.01, '0.03 m beyond')])
def test_a_standing_error_is_told_and_not_among_the_figures(
        off: float, amplitude: float, told: str) -> None:
    """From 5 % of the step on: of less it is a part of the figures. It sank 1 mm at first."""
    ramp = np.clip((np.arange(220) - BEFORE) / RISES, 0.0, 1.0)
    output = 0.05 - off + amplitude * ramp
    output[:BEFORE // 2] += 0.001
    trace = {'position': output, 'position_reference': 0.05 + amplitude * (ramp > 0.0)}
    found = evaluate(loop(actuator_sheet('isa_v5')), trace, BEFORE, 0.05, amplitude, RATE)
    assert found.standing_error == pytest.approx(off if told else 0.0, abs=1e-15)
    assert found.figures.steady_error == pytest.approx(0.0 if told else off, abs=1e-15)
    assert found.follows and found.figures.rise_time == pytest.approx(8e-3, rel=1e-9)
    lines = [line for line in summary(found).splitlines() if line.startswith('at the step')]
    assert lines == ([f'at the step it was {told} its reference: all figures are of the '
                      'change from there'] if told else [])


@pytest.mark.parametrize(('swing', 'drift', 'standing'), [
    (0.00035, 0.0, 0.002), (0.00055, 0.0, 0.0), (0.0, 0.2, 0.002), (0.00035, -0.2, 0.002)])
def test_what_swings_before_a_step_has_no_standing_error(
        swing: float, drift: float, standing: float) -> None:
    """By more than 5 % of the step from peak to peak; of a drift it is where the step finds it."""
    rows = np.arange(220)
    before = drift * (rows - BEFORE) / RATE + swing * (rows % 2 - 0.5)
    trace = {'position': 0.048 + np.where(rows < BEFORE, before, 0.01),
             'position_reference': np.where(rows < BEFORE, 0.05, 0.06)}
    found = evaluate(loop(actuator_sheet('isa_v5')), trace, BEFORE, 0.05, 0.01, RATE)
    assert found.standing_error == pytest.approx(standing, abs=max(1e-15, 0.2 * swing))


LATE = np.maximum(np.arange(220) - 200, 0) / RATE
WAVE = (-1.0) ** np.arange(220)


@pytest.mark.parametrize(('more', 'size', 'follows'), [
    (0.00019 * WAVE, 0.0, True), (0.00021 * WAVE, 0.00021, True),
    (0.0049 * WAVE, 0.0049, True), (0.0051 * WAVE, 0.0051, False),
    (1.8 * LATE, 0.0, False), (0.0051 * WAVE + 1.8 * LATE, 0.0051, False)])
def test_a_loop_that_swings_on_hunts(more: np.ndarray, size: float, follows: bool) -> None:
    """By more than 2 % of 10 mm; a drift of 36 mm, from 1.8 m/s, is no swing."""
    found = stepped(0.01 + more)
    assert found.swing.size == pytest.approx(size, rel=0.08, abs=0.0)
    assert (found.hunts, found.follows) == (size > 0.0, follows)
    lines = summary(found).splitlines()
    assert any('does not follow' in line for line in lines) is not follows
    told = [line for line in lines if line.startswith('the loop hunts: at the end it swings by')]
    assert len(told) == (size > 0.0)
    if size == 0.0049:
        assert told[0].endswith(' m at 500 Hz, 49 % of the step')


@pytest.mark.parametrize(('decay', 'hunts'), [(0.05, False), (0.2, True)])
def test_a_swing_that_decays_is_none_of_a_loop_that_hunts(decay: float, hunts: bool) -> None:
    """By a third, or by a tenth, within a tenth of the time."""
    assert stepped(0.01 + 0.012 * np.exp(-np.arange(220) / RATE / decay) * WAVE).hunts is hunts


def test_a_period_that_is_longer_than_the_end_is_noticed_by_its_deviation() -> None:
    """0.8 of a period of 30 mm in the last tenth."""
    found = stepped(0.01 + 0.03 * np.sin(2.0 * np.pi * 40.0 * np.arange(220) / RATE))
    assert found.swing.size == 0.0 and found.hunts and not found.follows


def stepped(output: np.ndarray) -> StepResponse:
    """Return a step of 10 mm, after which there is an output."""
    rows = np.arange(220)
    return evaluate(loop(actuator_sheet('isa_v5')), {
        'position': np.where(rows < BEFORE, 0.0, output),
        'position_reference': np.where(rows < BEFORE, 0.0, 0.01)}, BEFORE, 0.0, 0.01, RATE)


@pytest.mark.parametrize(('load', 'amplitude', 'is_refused'), [
    ('mass', None, True), ('mass', 20.0, False), ('blocked', None, False)])
def test_a_step_into_the_end_of_the_travel_has_no_figures(
        load: str, amplitude: float | None, is_refused: bool) -> None:
    """750 N on 50 kg travel the half stroke of 50 mm within 0.1 s: an overshoot of 738 %."""
    found = rig(Choice(name='isa_v5', loop='force', load=load))
    if is_refused:
        with pytest.raises(ConfigError, match='isa_v5: runs into the end of its travel 1[01]'):
            step(found, 0.15, amplitude)
        return
    assert step(found, 0.15, amplitude).figures.overshoot < 1.0
