"""
A layout as Lichtblick reads it, and Foxglove, whose format it is.

There is no published schema. `validateLayoutData` of Lichtblick (packages/suite-base/src/util/
layout.ts, version 1.28.1) wants ``configById``, ``globalVariables`` and ``playbackConfig`` with a
number as ``speed``. A panel's id is its type, ``!`` and a text; ``layout`` is a tree of ids. The
text in a panel's bar is `lichtblickPanelTitle` there and `foxglovePanelTitle` in Foxglove.
"""

from collections.abc import Iterator, Sequence
import json
from typing import Any

from scripts.layouts.content import Diagram, LayoutPage, state_of

_TABS = 'Tab!pages'
_DIAGNOSTICS, _EVENTS = 'DiagnosticSummary!diagnostics', 'RosOut!events'
_PLOT: dict[str, Any] = {
    'showXAxisLabels': True, 'showYAxisLabels': True, 'showLegend': True,
    'legendDisplay': 'floating', 'showPlotValuesInLegend': True, 'isSynced': True,
    'xAxisVal': 'timestamp', 'sidebarDimension': 240}


def text(pages: Sequence[LayoutPage], actuators: Sequence[str]) -> str:
    """Return the file: the pages as tabs, beside states of the actuators, events, diagnostics."""
    states = 'StateTransitions!states'
    panels = dict(_plots(pages))
    panels[_TABS] = {'activeTabIdx': 0, 'tabs': [
        {'title': page.title,
         'layout': _stack([_id(page, diagram) for diagram in page.diagrams])} for page in pages]}
    panels[states] = {**_titled('device states'), 'isSynced': True, 'paths': [
        {'value': '.'.join(state_of(name)), 'label': name, 'timestampMethod': 'receiveTime'}
        for name in actuators]}
    panels[_EVENTS] = {**_titled('events'), 'searchTerms': [], 'minLogLevel': 1,
                       'topicToRender': '/coordinator/events'}
    panels[_DIAGNOSTICS] = {
        **_titled('diagnostics'), 'minLevel': 0, 'pinnedIds': [], 'hardwareIdFilter': '',
        'topicToRender': '/diagnostics', 'sortByLevel': True}
    layout = {
        'configById': panels, 'globalVariables': {}, 'userNodes': {},
        'playbackConfig': {'speed': 1}, 'version': 1,
        'layout': {'direction': 'row', 'splitPercentage': 70, 'first': _TABS,
                   'second': _stack([states, _EVENTS, _DIAGNOSTICS])}}
    return json.dumps(layout, indent=1) + '\n'


def _plots(pages: Sequence[LayoutPage]) -> Iterator[tuple[str, dict[str, Any]]]:
    for page in pages:
        for diagram in page.diagrams:
            yield _id(page, diagram), {
                **_PLOT, **_titled(f'{page.title}: {diagram.title}'), 'paths': [
                    {'value': f'{curve.topic}.{curve.path}', 'label': curve.label,
                     'color': curve.colour, 'enabled': True, 'timestampMethod': 'receiveTime'}
                    for curve in diagram.curves]}


def _titled(text: str) -> dict[str, str]:
    """Return the keys of a panel's title, one of each program."""
    return {'lichtblickPanelTitle': text, 'foxglovePanelTitle': text}


def _id(page: LayoutPage, diagram: Diagram) -> str:
    """Return the id of a diagram's panel: its place, so that no two are equal."""
    return f'Plot!{page.title}-{page.diagrams.index(diagram)}'


def _stack(panels: Sequence[str]) -> Any:
    """Return the tree of panels below each other, all of one height; of one panel its id."""
    first, *others = panels
    return first if not others else {
        'direction': 'column', 'splitPercentage': 100 / len(panels), 'first': first,
        'second': _stack(others)}
