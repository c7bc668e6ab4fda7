"""Groups of panels drawn for papers: curves, marks, and what is left of very many samples."""

from isa_ros.analysis.report.figures import figure_of
from isa_ros.analysis.report.marks import Marks
from isa_ros.analysis.report.panels import Curve, Group, Panel
from isa_ros.analysis.signals.signals import Signal
from isa_ros.run.events import Event
import numpy as np

T = np.arange(101) * 0.01
GROUP = Group('ram', 'the ram', [
    Panel('force', 'kN', 1e3, [
        Curve('measured', Signal(T, 5e3 * T)),
        Curve('reference', Signal(T, 4e3 * T), is_reference=True)], ''),
    Panel('spool', 'mm', 1e-3, [Curve('measured', Signal(T, 1e-3 * T))], '')], ('ram',))


def test_curves_have_the_unit_of_their_panel():
    force, spool = figure_of(GROUP, Marks([], [])).axes
    measured, reference = force.get_lines()
    assert np.array_equal(measured.get_ydata(), 5e3 * T / 1e3)
    assert (measured.get_linestyle(), reference.get_linestyle()) == ('-', '--')
    assert [force.get_ylabel(), spool.get_ylabel()] == ['force, kN', 'spool, mm']
    assert spool.get_xlabel() == 'simulation time, s'


def test_events_are_lines_and_trips_are_named_once():
    marks = Marks([], [Event(0.25, 'ram', 'trip', 'overload, 5 N > 4 N'),
                       Event(0.5, 'ram', 'warning', 'hot')])
    force, spool = figure_of(GROUP, marks).axes
    for ax, n_curves in ((force, 2), (spool, 1)):
        lines = ax.get_lines()[n_curves:]
        assert [line.get_xdata()[0] for line in lines] == [0.25, 0.5]
        assert [line.get_color() for line in lines] == ['black', 'gray']
    assert [own.get_text() for own in force.texts] == ['overload']
    assert not spool.texts
