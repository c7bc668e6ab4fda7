"""Marked parts of a page are replaced, and nothing else."""

from isa_ros.errors import ConfigError
from isa_ros.text.marked import with_parts
import pytest

PAGE = 'above\n<!-- first -->\nold\n<!-- end -->\nbetween\n<!-- second -->\n<!-- end -->\nbelow\n'


def test_only_the_marked_parts_change():
    assert with_parts(PAGE, {'first': ['one', 'two'], 'second': ['three']}) == (
        'above\n<!-- first -->\n\none\ntwo\n\n<!-- end -->\nbetween\n'
        '<!-- second -->\n\nthree\n\n<!-- end -->\nbelow\n')


def test_a_second_time_changes_nothing():
    once = with_parts(PAGE, {'first': ['one']})
    assert with_parts(once, {'first': ['one']}) == once


@pytest.mark.parametrize('page, n', [
    ('no marker', 0), ('<!-- first -->\nno end', 1), (PAGE + '<!-- first -->\n<!-- end -->', 2)])
def test_a_page_without_just_this_part_is_refused(page, n):
    with pytest.raises(ConfigError, match=f'is in the page {n} times, must be once'):
        with_parts(page, {'first': []})
