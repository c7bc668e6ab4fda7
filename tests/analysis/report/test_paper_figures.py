"""Figures of the paper from a run: the right signals in the paper's colours."""

from isa_ros.analysis.report.characteristics import RESPONSES
from isa_ros.analysis.report.paper_figures import LAYOUTS, paper_figure, shown
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.analysis.signals.signals import signals_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError
from isa_ros.scenario.figures import FIGURES
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
import numpy as np
import pytest


@pytest.fixture(scope='module')
def step() -> Result:
    """Return the torque step."""
    return load('rig_rotary', 'step').simulate()


def test_every_name_a_scenario_may_give_has_a_figure():
    assert {*LAYOUTS, *RESPONSES} == set(FIGURES)


def test_the_reference_is_dashed_blue_and_the_applied_torque_solid_red(step):
    ax, = paper_figure('torque_step', signals_of(step)).axes
    reference, applied = ax.get_lines()
    assert (reference.get_color(), reference.get_linestyle()) == ('blue', '--')
    assert (applied.get_color(), applied.get_linestyle()) == ('red', '-')
    assert np.array_equal(applied.get_ydata(), step['rotor.force'])
    # 17 Nm from 0.1 to 0.3 s, then back: the impedance has no stiffness
    assert set(np.round(reference.get_ydata(), 9)) == {0.0, 17.0}


@pytest.mark.parametrize('name', LAYOUTS)
def test_every_figure_can_be_drawn_from_a_rig(step, name):
    figure = paper_figure(name, signals_of(step))
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert len(labels) == len(LAYOUTS[name].panels)
    assert set(labels) <= {'position, deg', 'torque, Nm'}


def test_a_reference_of_a_block_that_is_off_is_not_drawn():
    """Under pure position control the torque has no reference, as in Fig 17."""
    off = {f'actuators.rotor.parameters.reu.{block}': {'kind': 'off'}
           for block in ('position', 'force')}
    changed = signals_of(load('rig_rotary').replace(off).simulate(0.01))
    for ax in paper_figure('weight', changed).axes:
        assert [line.get_color() for line in ax.get_lines()] == ['red']


def test_of_a_leg_the_knee_is_shown():
    assert shown(load_run(find('leg', CONFIG))).name == 'kfe'


def test_an_unknown_figure_is_refused(step):
    with pytest.raises(ConfigError, match='torque_stop is not a figure; did you mean torque_step'):
        paper_figure('torque_stop', signals_of(step))


def test_the_report_begins_with_the_figure_of_the_scenario(step, tmp_path):
    written = write_report(recorded(step.save(tmp_path / 'bag')), tmp_path / 'page.html')
    assert [path.name for path in written] == [
        'page.html', 'page_torque_step.png', 'page_torque_step.svg', 'page_rotor.png',
        'page_rotor.svg']
    page = written[0].read_text()
    assert page.index('<img alt="torque_step" src="data:image/png;') < page.index('<main>')
