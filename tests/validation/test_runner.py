"""Groups in worker processes: order, selection, and errors."""

import re
import sys

from isa_ros.cli.main import main
from isa_ros.errors import ConfigError
from isa_ros.validation.runner import (
    chosen, GroupFailed, is_reached, only_of, run_group, validated)
import pytest
from tests.text.terminal import Terminal
from tests.validation.groups import DIVERGED, GAINS, GOOD, MISSED, REFUSED

GROUPS = (GOOD, MISSED)


@pytest.fixture(scope='module')
def results():
    """Return both groups, run in workers."""
    return validated(GROUPS)


def test_results_come_in_the_order_of_the_groups(results):
    """The order is that of the list, although the long group starts first."""
    assert [result.group for result in results] == ['good', 'missed']
    assert [entry.name for entry in results[0].entries] == ['a', 'b']


def test_figures_cross_from_the_worker_as_png(results):
    picture, = results[0].pictures
    assert picture.name == 'line' and picture.png.startswith(b'\x89PNG')
    assert run_group(GOOD).pictures[0].png == picture.png


def test_one_missed_entry_is_a_no(results):
    assert is_reached(results[:1]) and not is_reached(results)


def test_progress_counts_the_groups():
    seen = []
    validated(GROUPS, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 2), (2, 2)]


def test_a_terminal_keeps_how_long_all_groups_took(monkeypatch):
    monkeypatch.setattr('isa_ros.validation.groups.GROUPS', (GOOD,))
    monkeypatch.setattr(sys, 'stderr', Terminal())
    assert main(['validate']) == 0
    assert re.fullmatch(r'\r1 of 1 groups, \d+ s\x1b\[K\n', sys.stderr.getvalue())


@pytest.mark.parametrize('only, groups', [
    (None, ['good', 'missed']), (['missed'], ['missed']), (['good.b'], ['good']),
    (['missed', 'good.b'], ['good', 'missed'])])
def test_only_chooses_groups(only, groups):
    assert [group.name for group in chosen(GROUPS, only)] == groups


def test_only_keeps_the_named_entries(results):
    assert [e.name for e in only_of(results[0], ['good.b', 'missed']).entries] == ['b']
    assert only_of(results[0], ['good.b', 'good']) == results[0] == only_of(results[0], [])


def test_only_names_both_sets_of_gains_or_one():
    both = run_group(GAINS)
    assert [e.key for e in only_of(both, ['gains.rise']).entries] == [
        'rise.table_4', 'rise.default']
    assert [e.key for e in only_of(both, ['gains.rise.default']).entries] == ['rise.default']


def test_an_unknown_name_is_answered_with_the_near_ones(results):
    with pytest.raises(ConfigError, match='--only gold.a: no such group; did you mean good'):
        chosen(GROUPS, ['gold.a'])
    with pytest.raises(ConfigError, match='--only missed.fare: no such entry; did you mean miss'):
        only_of(results[1], ['missed.fare'])


@pytest.mark.parametrize('group, code, message', [
    (REFUSED, 2, 'refused: no such model'), (DIVERGED, 4, 'diverged: spool = nan at t = 0.001')])
def test_a_group_that_fails_keeps_its_exit_code(group, code, message):
    """The error passes the process boundary, where an exception is rebuilt from its arguments."""
    with pytest.raises(GroupFailed, match=message) as caught:
        validated((GOOD, group))
    assert caught.value.exit_code == code
