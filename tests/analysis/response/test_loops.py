"""Loops for an excitation: the outermost block, its unit and its largest amplitude."""

from dataclasses import replace

from isa_ros.analysis.response.loops import loop_of, outermost, rating
from isa_ros.errors import ConfigError
from isa_ros.plant.return_spring import CoilSpring
from isa_ros.reu.wiring import active, Off, VARIABLES
import numpy as np
import pytest
from tests.sheets import actuator_sheet, override


@pytest.mark.parametrize('model', ['smart_manifold', 'isa_v5'])
def test_everything_outside_a_loop_is_off_and_inside_it_as_it_was(model):
    sheet = actuator_sheet(model)
    for name in active(sheet.reu):
        alone, place = outermost(sheet, name), VARIABLES.index(name)
        assert all(isinstance(getattr(alone.reu, other), Off) for other in VARIABLES[:place])
        assert all(getattr(alone.reu, other) == getattr(sheet.reu, other)
                   for other in VARIABLES[place:])
        assert alone.plant == sheet.plant


def test_a_loop_that_is_off_is_refused_with_those_that_are_on():
    with pytest.raises(ConfigError, match='pressure loop is off; on: position, force, spool'):
        outermost(actuator_sheet('isa_v5'), 'pressure')
    with pytest.raises(ConfigError, match="loop 'torque' is unknown; valid: position, force"):
        outermost(actuator_sheet('isa_v5'), 'torque')


def test_a_spool_with_mechanical_feedback_is_excited_through_the_current():
    """The valve closes the loop: 0.178 mm is 5 mA of the setpoint's series scale."""
    loop = loop_of(actuator_sheet('smart_manifold'), 'spool')
    assert loop.inward == 'current_reference'
    assert loop.per_reference * loop.largest == pytest.approx(5e-3, rel=1e-3)   # 0.178/0.0356
    assert loop.largest == pytest.approx(178e-6, rel=1e-12, abs=0.0)


def test_the_current_is_the_amplifiers_twice_the_series_scale():
    """Errata 4: coils in parallel, +-10 mA for the spool's whole travel."""
    loop = loop_of(actuator_sheet('smart_manifold'), 'current')
    assert loop.largest == pytest.approx(10e-3, rel=1e-3)   # 0.178 mm / 0.0356 mm/mA * 2
    assert loop.per_reference == 0.5


@pytest.mark.parametrize(('model', 'force', 'unit'), [
    ('smart_manifold', 17.0, 'Nm'), ('isa_v5', 750.0, 'N')])
def test_force_is_excited_by_a_tenth_of_its_rating(model, force, unit):
    """The paper's force bandwidth."""
    loop = loop_of(actuator_sheet(model), 'force')
    assert (loop.amplitude, loop.unit.symbol) == (pytest.approx(force, rel=1e-12), unit)


@pytest.mark.parametrize(('preload', 'amplitude'), [
    (800.0, 400.0), (0.0, 1.0), (1e5, 1.0)], ids=['held', 'no_preload', 'strong'])
def test_a_single_acting_cylinder_is_excited_by_no_more_than_half_of_its_preload(
        preload, amplitude):
    """Without pressure only the spring pulls; without a preload by a tenth of the rating."""
    sheet = actuator_sheet('cylinder')
    tenth = loop_of(sheet, 'force').amplitude
    spring = CoilSpring(preload=preload, stiffness=6e3, open_to='tank')
    own = override(sheet, 'plant.return_spring', spring)
    assert loop_of(own, 'force').amplitude == (amplitude if amplitude > 1.0 else tenth)


def test_without_an_impedance_the_rating_is_the_hydraulic_stall():
    """Errata 15: A_A P_S = 7515 N."""
    sheet = outermost(actuator_sheet('isa_v5'), 'force')
    assert rating(sheet) == pytest.approx(7515.0, abs=0.5)


def test_open_closed_and_plant_are_ratios_of_one_run():
    loop = loop_of(actuator_sheet('isa_v5'), 'force')
    trace = {'force_reference': np.full(2, 3.0), 'force': np.ones(2),
             'spool_reference': np.full(2, 2e-3)}
    assert list(loop.input_of('closed', trace)) == [3.0, 3.0]
    assert list(loop.input_of('open', trace)) == [2.0, 2.0]
    assert list(loop.input_of('plant', trace)) == [2e-3, 2e-3]
    assert loop.response_unit('plant').symbol == 'N/mm'
    assert loop.response_unit('plant').scale == pytest.approx(1e3, rel=1e-12)


def test_a_current_loop_closed_in_the_plant_has_no_plant():
    loop = loop_of(actuator_sheet('isa_v5'), 'current')
    with pytest.raises(ConfigError, match='--of plant: the current loop is closed inside'):
        loop.input_of('plant', {'current_reference': np.zeros(2)})


def test_nothing_changes_the_sheet_that_is_given():
    sheet = actuator_sheet('isa_v5')
    before = replace(sheet)
    loop_of(sheet, 'current')
    assert sheet == before
