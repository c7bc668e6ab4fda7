"""The table, the JSON and the page."""

import json

from isa_ros.text.json_file import write_tree
from isa_ros.validation.page import as_text, as_tree, write_page
from isa_ros.validation.runner import run_group
import pytest
from tests.validation.groups import GAINS, GOOD, MISSED

FIELDS = ('name', 'source', 'where', 'gains', 'paper', 'ours', 'unit', 'tolerance',
          'tolerance_source', 'reading', 'verdict', 'reason')


@pytest.fixture(scope='module')
def results():
    """Return a group that is reached and one that is not."""
    return run_group(GOOD), run_group(MISSED)


def test_the_table_gives_the_reason_of_what_is_not_reached(results):
    text = as_text(results)
    assert 'good.b' in text and '0.9 to 1.1' in text
    assert 'missed.far is not reached: the spring is too soft' in text
    assert 'missed.lost is not reached: for no known reason' in text
    assert text.endswith(
        'paper: 2 entries, 1 reached, 0 reached as read, 1 not reached; '
        'own: 2 entries, 1 reached, 0 reached as read, 1 not reached')


def test_json_has_every_field_and_no_nan(results, tmp_path):
    write_tree(as_tree(results), tmp_path / 'v.json')
    entries = json.loads((tmp_path / 'v.json').read_text())
    assert entries == as_tree(results)
    assert all(tuple(entry) == FIELDS for entry in entries)
    assert [entry['source'] for entry in entries] == ['paper', 'own', 'paper', 'own']
    assert entries[0]['tolerance'] == [0.9, 1.1]
    assert entries[3]['ours'] is None and entries[3]['verdict'] == 'not reached'
    assert [entry['reason'] for entry in entries] == ['', '', 'the spring is too soft', '']


def test_the_page_shows_every_entry_and_figure(results, tmp_path):
    written = write_page(results, tmp_path / 'docs')
    assert [path.name for path in written] == ['validation.md', 'validation_line.png']
    page = written[0].read_text()
    assert '| good.a | paper | Fig 1 | 1 | 1 | m | 0.9 to 1.1 | a tenth |  | reached |' in page
    assert '| paper | 2 | 1 | 0 | 1 |\n| own | 2 | 1 | 0 | 1 |' in page
    assert '**not reached**' in page and '- missed.far is not reached: the spring' in page
    assert '![A line.](figures/validation_line.png)' in page
    assert (tmp_path / 'docs' / 'figures' / 'validation_line.png').read_bytes()[:4] == b'\x89PNG'


def test_each_set_of_gains_has_its_column(tmp_path):
    """An entry of two sets is one row with both values, and says which one misses."""
    page = write_page([run_group(GAINS)], tmp_path)[0].read_text()
    assert '| paper | table_4 | ours | default | unit |' in page
    row = '| gains.rise | paper | Fig 1 | 1 | 1 |  | 2 | m | 0.9 to 1.1 | a tenth |  | '
    assert row + 'table_4: reached, default: **not reached** |' in page
    assert '| gains.alone | paper | Fig 1 | 1 |  | 1 |  | m |' in page
    assert '- gains.rise.default is not reached: slower' in page


def test_what_is_not_compared_is_listed(results, tmp_path):
    page = write_page(results, tmp_path)[0].read_text()
    assert '| Table 3 | Encoder Baud rate, ISA | 1 Mbps | not modelled' in page
    assert '| Table 3 | Max current, ISA | 125 mA | not modelled' in page
