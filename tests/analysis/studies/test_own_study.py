"""The forms of a study with a rig of its own."""

from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.text.table import LEFT
import pytest

ROWS = [('case', 'mm'), ('far', '12.5'), ('farther', '3')]
STUDY = OwnStudy(
    'reach', 'How far it reaches', lambda progress: [1.0, 2.0], lambda found: ROWS,
    lambda found: {'unit': 'm', 'outcomes': found}, '# Reach',
    lambda page, found: page.paragraph(f'{len(found)} cases.'))


def test_its_text_is_the_title_over_the_table():
    lines = STUDY.as_text([]).splitlines()
    assert lines[0] == 'How far it reaches'
    assert [line.split() for line in lines[1:]] == [list(row) for row in ROWS]


@pytest.mark.parametrize(('sides', 'first'), [('r', '    far'), (LEFT, 'far    ')])
def test_a_table_of_numbers_stands_at_its_right(sides, first):
    own = OwnStudy(*(getattr(STUDY, name) for name in (
        'name', 'title', 'results', 'table', 'numbers', 'head', 'fill')), sides)
    assert any(line.startswith(first) for line in own.as_text([]).splitlines())


def test_json_has_name_and_title_before_the_numbers():
    assert list(STUDY.as_tree([1.0]).items()) == [
        ('name', 'reach'), ('title', 'How far it reaches'), ('unit', 'm'), ('outcomes', [1.0])]


def test_its_page_is_called_as_it_is(tmp_path):
    page, = STUDY.write_page([1.0, 2.0], tmp_path)
    assert page == tmp_path / 'reach.md'
    assert page.read_text() == '# Reach\n\n2 cases.\n'
