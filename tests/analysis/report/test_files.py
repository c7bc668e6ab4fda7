"""The files of a report: each figure as PNG and SVG, drawn with one layout."""

from unittest.mock import patch

from isa_ros.analysis.report.document import GENERATOR
from isa_ros.analysis.report.files import refuse_foreign, write_files
from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
import pytest


@pytest.fixture
def figures():
    """Return two figures with labels that a layout has to make room for."""
    drawn = {}
    for name in ('leg', 'knee'):
        drawn[name] = Figure(figsize=(3.0, 2.0), layout='constrained')
        for axes in drawn[name].subplots(2, 1):
            axes.plot([0.0, 1.0], [0.0, 1e6])
            axes.set_ylabel('force, N')
            axes.set_xlabel('time, s')
    return drawn


@pytest.mark.parametrize('setting', ['figure.autolayout', 'figure.constrained_layout.use'])
def test_both_files_of_a_figure_have_the_layout_of_the_first(
        setting, tmp_path, figures, monkeypatch):
    """Whatever the settings of the user."""
    monkeypatch.setitem(rcParams, setting, True)
    execute = ConstrainedLayoutEngine.execute
    with patch.object(
            ConstrainedLayoutEngine, 'execute', autospec=True, side_effect=execute) as laid:
        written = write_files(tmp_path / 'report.html', GENERATOR, figures)
    assert [call.args[1] for call in laid.call_args_list] == list(figures.values())
    assert [path.name for path in written] == [
        'report.html', 'report_leg.png', 'report_leg.svg', 'report_knee.png', 'report_knee.svg']
    assert all(figure.get_layout_engine() is None for figure in figures.values())
    for figure in figures.values():     # with room for the label between the axes
        above, below = (axes.get_position() for axes in figure.axes)
        assert above.y0 - below.y1 > 0.3 and below.y0 > 0.2
    refuse_foreign(tmp_path / 'report.html', list(figures))


def test_the_same_figures_give_the_same_bytes(tmp_path, figures):
    for name in ('a', 'b'):
        write_files(tmp_path / name / 'report.html', GENERATOR, figures)
    for name in ('report_leg.png', 'report_leg.svg', 'report_knee.svg'):
        assert (tmp_path / 'a' / name).read_bytes() == (tmp_path / 'b' / name).read_bytes()
