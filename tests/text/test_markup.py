"""HTML of texts that nobody has checked."""

import base64
import json

from isa_ros.text.markup import (
    details, download, escaped, json_in_page, lines, pairs, picture, table, tag)
import pytest

EVIL = '<script>alert("1")</script>&\'\x1b[2J\u202e'
SAFE = ('&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;&#x27;\\x1b[2J\\u202e')


def test_a_text_has_no_markup_and_no_codes_of_terminals():
    assert escaped(EVIL) == SAFE


def test_lines_stay_lines_and_other_codes_are_shown():
    assert lines('a:\n  b: <1>\r\n\n') == '<pre>a:\n  b: &lt;1&gt;\\r</pre>'


@pytest.mark.parametrize('made', [
    lines(f'a\n{EVIL}'), tag('p', EVIL), tag('li', EVIL, 'bad'),
    table([('h',), (EVIL,)]), table([(EVIL,)]),
    pairs([(EVIL, 'x')]), details(EVIL, ''), download(EVIL, 'x'), picture(EVIL, b'')])
def test_every_piece_escapes_what_it_is_given(made):
    assert SAFE in made and '<script' not in made and '\x1b' not in made


def test_tables_lead_to_times_below_their_header():
    rows = [('a', 'b'), ('1', '2'), ('3', '4'), ('5', '6')]
    assert table(rows, [0.25, None]) == (
        '<div class="scroll"><table><tr><th>a</th><th>b</th></tr>'
        '<tr data-t="0.25"><td>1</td><td>2</td></tr><tr><td>3</td><td>4</td></tr>'
        '<tr><td>5</td><td>6</td></tr></table></div>')
    assert table([]) == ''


def test_a_long_cell_may_be_broken():
    assert '<td class="long">' in table([('',), ('x' * 61,)])
    assert '<td class="long">' not in table([('',), ('x' * 60,)])


def test_pairs_have_no_header():
    assert pairs([('seed', '3')]) == (
        '<div class="scroll"><table><tr><td>seed</td><td>3</td></tr></table></div>')


def test_details_are_closed_unless_told():
    assert details('more', '<b>x</b>') == '<details><summary>more</summary><b>x</b></details>'
    assert details('more', '', is_open=True).startswith('<details open><summary>')


def test_a_download_has_the_text():
    link = download('a.yaml', 'x: \u00fc')
    assert base64.b64decode(link.partition('base64,')[2].partition('"')[0]) == b'x: \xc3\xbc'
    assert link.startswith('<a download="a.yaml" href="data:text/plain;base64,')


def test_json_cannot_end_its_element():
    text = json_in_page({'a': '</script><!--', 'b': [1.5]})
    assert '<' not in text and json.loads(text) == {'a': '</script><!--', 'b': [1.5]}
    with pytest.raises(ValueError, match='JSON compliant'):
        json_in_page(float('nan'))
