"""The table, the JSON and the page."""

import json
from pathlib import Path
import re

from isa_ros.text.json_file import write_tree
from isa_ros.validation.page import _HEAD, as_text, as_tree, write_page
from isa_ros.validation.runner import run_group
import pytest
from tests.validation.groups import GAINS, GOOD, KINDS, MISSED

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
    assert re.search(r'^good.seen +it hums +0.25 +N +held by hand$', text, re.M)
    assert text.endswith(
        'printed number, simulated: 1 of 2 reached; printed number, simulated with retuned '
        'gains: 0 of 0 reached; statement in words, simulated: 0 of 0 reached; statement in '
        'words, simulated with retuned gains: 0 of 0 reached; printed input, read '
        'back: 0 of 0 reached; as read, not as printed: 0 of 0 reached; own: 1 of 2 reached')


def test_inputs_and_readings_are_counted_apart(tmp_path):
    """A printed value that is not met counts with neither numbers nor inputs, our own as own."""
    page = write_page([run_group(KINDS)], tmp_path)[0].read_text()
    assert '\n'.join((
        '| printed number, simulated | 1 | 1 | 0 |',
        '| printed number, simulated with retuned gains | 0 | 0 | 0 |',
        '| statement in words, simulated | 2 | 1 | 1 |',
        '| statement in words, simulated with retuned gains | 0 | 0 | 0 |',
        '| printed input, read back | 3 | 3 | 0 |', '| as read, not as printed | 4 | 3 | 1 |',
        '| own | 5 | 1 | 4 |')) in page
    assert '| kinds.r0 | paper | Fig 1 | 1 | 5 | m | 4.9 to 5.1 | a tenth | erratum 1: one | ' \
        'as read, not as printed |' in page


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
    assert '| good.seen | Fig 2 | it hums | 0.25 | N | held by hand |' in page
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
    assert '| printed number, simulated | 2 | 2 | 0 |' in page
    assert '| printed number, simulated with retuned gains | 1 | 0 | 1 |' in page


def test_what_is_not_compared_is_listed(results, tmp_path):
    page = write_page(results, tmp_path)[0].read_text()
    assert ('| Table 3 | Encoder Baud rate, ISA | 1 Mbps | in the variant `data_sheet_sensors` '
            'only') in page
    assert '| Table 3 | Max current, ISA | 125 mA | not modelled' in page


def test_the_head_of_the_stored_page_is_that_of_the_code() -> None:
    """Also what it says about measured data, which no run of the command repeats here."""
    stored = (Path(__file__).parents[2] / 'docs' / 'validation.md').read_text(encoding='utf-8')
    assert stored.startswith(_HEAD.rstrip())
