"""
Pieces of HTML from texts that nobody has checked.

What a function is given as text is escaped, and characters that are not printed are shown as their
codes; only what these functions return is markup.
"""

import base64
from collections.abc import Sequence
import html
import json
from typing import Any

from isa_ros.errors import printable
from isa_ros.text.table import Cells

_LONG = 60      # characters of a cell, from which on its lines may be broken


def escaped(text: str) -> str:
    """Return a text as it may stand in an element or in the value of an attribute."""
    return html.escape(printable(text))


def tag(name: str, text: str, css_class: str = '') -> str:
    """Return an element that has a text."""
    return f'<{name}{_class(css_class)}>{escaped(text)}</{name}>'


def lines(text: str) -> str:
    """Return an element that has a text with its lines and indents."""
    own = '\n'.join(map(escaped, text.rstrip('\n').split('\n')))
    return f'<pre>{own}</pre>'


def table(rows: Sequence[Cells], times: Sequence[float | None] = ()) -> str:
    """
    Return a table, its header first; '' without rows.

    ``times`` are seconds that the rows below the header lead to, None: nowhere.
    """
    if not rows:
        return ''
    head, *body = rows
    led = [*times, *[None] * (len(body) - len(times))]
    lines = [_row('th', head, None), *(_row('td', row, t) for row, t in zip(body, led))]
    return f'<div class="scroll"><table>{"".join(lines)}</table></div>'


def pairs(rows: Sequence[tuple[str, str]]) -> str:
    """Return a table of names and values without a header."""
    return table([('', ''), *rows]).replace('<tr><th></th><th></th></tr>', '', 1)


def details(summary: str, inner: str, *, is_open: bool = False) -> str:
    """Return what is shown on demand; ``inner`` is markup."""
    return (f'<details{" open" if is_open else ""}><summary>{escaped(summary)}</summary>'
            f'{inner}</details>')


def download(name: str, text: str) -> str:
    """Return a link that saves a text as a file."""
    data, own = base64.b64encode(text.encode()).decode(), escaped(name)
    return f'<a download="{own}" href="data:text/plain;base64,{data}">{own}</a>'


def picture(name: str, png: bytes) -> str:
    """Return a picture that is part of the page."""
    data = base64.b64encode(png).decode()
    return f'<img alt="{escaped(name)}" src="data:image/png;base64,{data}">'


def json_in_page(tree: Any) -> str:
    """Return JSON that may stand in a script element of type application/json."""
    return json.dumps(tree, separators=(',', ':'), allow_nan=False).replace('<', '\\u003c')


def _row(cell: str, texts: Cells, t_s: float | None) -> str:
    leads = '' if t_s is None else f' data-t="{t_s:.9g}"'
    return f'<tr{leads}>' + ''.join(
        tag(cell, text, 'long' if len(text) > _LONG else '') for text in texts) + '</tr>'


def _class(name: str) -> str:
    return f' class="{name}"' if name else ''
