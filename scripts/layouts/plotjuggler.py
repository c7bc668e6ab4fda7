"""
A layout as PlotJuggler 3 and 4 read it: equal trees of tabs, splitters and plots.

3 (plotjuggler_app/mainwindow.cpp, plot_docker.cpp, plotwidget.cpp of 3.17) finds a curve by the
name of its series, the topic and the field in one, and takes a tab's docks from a `DockSplitter`
alone, with as many sizes as its count. 4 has ``pj4_version`` and finds a curve by topic and field
in whatever data is loaded, if ``binding`` is ``generic``.
"""

from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from scripts.layouts.content import Diagram, LayoutPage, TopicCurve


def text(pages: Sequence[LayoutPage], version: int) -> str:
    """Return the file for a version, 3 or 4."""
    root = Element('root', {} if version == 3 else {
        'format': 'PlotJuggler', 'pj4_version': '4', 'binding': 'generic'})
    widget = SubElement(root, 'tabbed_widget', parent='main_window', name='Main Window')
    for page in pages:
        tab = SubElement(widget, 'Tab', tab_name=page.title, containers='1')
        n = len(page.diagrams)
        splitter = SubElement(
            SubElement(tab, 'Container'), 'DockSplitter', orientation='-', count=str(n),
            sizes=';'.join([f'{1 / n:.6f}'] * n))
        for k, diagram in enumerate(page.diagrams):
            _plot(splitter, diagram, version, f'{page.title}-{k}')
        if version == 4:
            tab.set('id', page.title)
    SubElement(widget, 'currentTabIndex', index='0')
    SubElement(root, 'use_relative_time_offset', enabled='1')
    ElementTree.indent(root, ' ')
    return f"<?xml version='1.0' encoding='UTF-8'?>\n{ElementTree.tostring(root, 'unicode')}\n"


def _plot(splitter: Element, diagram: Diagram, version: int, identity: str) -> None:
    area = SubElement(splitter, 'DockArea', name=diagram.title)
    plot = SubElement(area, 'plot', mode='TimeSeries', style='Lines')
    if version == 4:
        area.set('id', f'area-{identity}')
        plot.set('id', f'plot-{identity}')
    for curve in diagram.curves:
        SubElement(plot, 'curve', _named(curve, version), color=curve.colour)


def _named(curve: TopicCurve, version: int) -> dict[str, str]:
    """Return how a curve is found."""
    return ({'name': curve.topic + curve.field} if version == 3
            else {'topic': curve.topic, 'field': curve.field})
