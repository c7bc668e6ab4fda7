"""
The HTML page of a report: one file that loads nothing and runs no script but its own.

Its Content-Security-Policy has the digests of its script and its style, so that markup in a name
of a hostile bag, should any ever get through, could not run.
"""

import base64
from collections.abc import Mapping, Sequence
import hashlib
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.analysis.report.encoding import Encoder
from isa_ros.analysis.report.marks import Marks
from isa_ros.analysis.report.panels import Curve, Group, Panel
from isa_ros.analysis.report.thinning import SignalThinning, thinning_for
from isa_ros.text.markup import escaped, json_in_page, tag
from isa_ros.vendor import uplot

GENERATOR = '<meta name="generator" content="isa_ros">'
"""By which a report is known, so that only reports are replaced."""

MOST_SAMPLES = 60_000_000
"""Of a page: about 40 MB of it, and as much memory of a browser as 12 actuators in 12 minutes."""
_THINNED = ('Too many samples for a page: of each signal there are the least and the greatest '
            'value in each of {0} parts of the run, and all samples around events.')

_BROWSER = Path(__file__).parent / 'browser'
_SCRIPTS = ('elements.js', 'signals.js', 'charts.js', 'page.js')
_COLORS = 8     # of report.css
_OPEN = 4       # groups that are open at first
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">{generator}
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><style>{style}</style></head>
<body><header><h1>{title}</h1>{head}</header>
<nav><span id="range"></span><button id="all">whole run</button><span id="cursor"></span>
<span class="mut">drag: zoom; double click or 0: whole run; ctrl and wheel, + and -: zoom;
arrows: move</span></nav>
<main></main>
<noscript>The diagrams need JavaScript; the tables above are complete without it.</noscript>
<script type="application/json" id="meta">{meta}</script>
<script type="text/plain" id="data">{data}</script>
<script>{script}</script></body></html>
"""


class Shown(NamedTuple):
    """A group of panels with what is marked in it."""

    group: Group
    marks: Marks


class Span(NamedTuple):
    """The time that a page shows, s."""

    begin: float
    end: float
    step: float


def document(title: str, head: str, shown: Sequence[Shown], span: Span) -> str:
    """Return a page; ``head`` is markup that stands above the diagrams."""
    thinning = thinning_of(shown)
    encoder = Encoder(thinning)
    groups = [_group(own, encoder, is_open=k < _OPEN) for k, own in enumerate(shown)]
    meta = {**span._asdict(), 'grids': encoder.grids, 'groups': groups}
    drawn_by = uplot()
    script = '\n'.join([
        f'/*! uPlot\n{drawn_by.licence}*/', drawn_by.script,
        *((_BROWSER / name).read_text(encoding='utf-8') for name in _SCRIPTS)])
    style = drawn_by.style + (_BROWSER / 'report.css').read_text(encoding='utf-8')
    policy = (f"default-src 'none'; script-src {_digest(script)}; style-src {_digest(style)}; "
              "img-src data:; base-uri 'none'; form-action 'none'")
    return _PAGE.format(
        generator=GENERATOR, policy=policy, title=escaped(title), style=style,
        head=head + ('' if thinning is None else tag('p', _THINNED.format(*thinning), 'mut')),
        meta=json_in_page(meta), data=encoder.text(), script=script)


def thinning_of(shown: Sequence[Shown]) -> SignalThinning | None:
    """Return how the samples of a page are thinned; None: it has all of them."""
    lengths = {id(curve.signal.values): len(curve.signal.t)
               for own in shown for panel in own.group.panels for curve in panel.curves}
    events = sorted({event.t_s for own in shown for event in own.marks.events})
    return thinning_for(sum(lengths.values()), len(lengths), MOST_SAMPLES, events)


def _digest(text: str) -> str:
    """Return the source of a script or a style for the policy."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _group(shown: Shown, encoder: Encoder, *, is_open: bool) -> Mapping[str, Any]:
    group, marks = shown
    return {
        'name': group.name, 'title': group.title, 'open': is_open,
        'lanes': len(group.sources) == 1,
        'panels': [_panel(own, encoder) for own in group.panels],
        'bands': [{'source': own.source, 'state': own.state, 'from': own.begin_s, 'to': own.end_s}
                  for own in marks.bands],
        'marks': [{'t': own.t_s, 'kind': own.kind, 'source': own.source,
                   'text': f'{own.source}, t = {own.t_s:.6f} s: {own.kind}: {own.what}'}
                  for own in marks.events]}


def _panel(panel: Panel, encoder: Encoder) -> Mapping[str, Any]:
    return {'label': panel.label, 'caption': panel.caption,
            'curves': [_curve(own, k, panel.scale, encoder)
                       for k, own in enumerate(panel.curves)]}


def _curve(curve: Curve, k: int, scale: float, encoder: Encoder) -> Mapping[str, Any]:
    stored = encoder.add(curve.signal)
    return {'label': curve.label, 'color': k % _COLORS, 'dash': curve.is_reference,
            'grid': stored.grid, 'offset': stored.offset,
            'low': stored.low / scale, 'high': stored.high / scale}
