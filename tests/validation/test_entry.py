"""Entries: verdicts, and invalid entries."""

import math

from isa_ros.paper.printed import cell, statement
from isa_ros.validation.entry import (
    around, as_printed, AS_READ, at_least, at_most, Drawing, Entry, INPUT, NOT_REACHED, OWN, PAPER,
    REACHED)
from isa_ros.validation.plots import stacked
import pytest
from tests.validation.groups import entry

READING = 'erratum 13: the flow times the pressure'


@pytest.mark.parametrize('ours, verdict', [
    (1.0, REACHED), (0.9, REACHED), (1.1, REACHED), (1.11, NOT_REACHED), (math.nan, NOT_REACHED),
    (math.inf, NOT_REACHED)])
def test_the_verdict_is_whether_ours_is_in_the_tolerance(ours, verdict):
    assert entry('x', ours).verdict == verdict


def test_a_printed_value_outside_the_tolerance_is_read(ours=5.0):
    """Its verdict is that the reading is reached, not the printed value."""
    read = entry('x', ours, tolerance=around(5.0, percent=1.0), reading=READING)
    assert read.verdict == AS_READ
    assert entry('x', 1.0, tolerance=around(5.0), reading=READING).verdict == NOT_REACHED
    assert read.is_read_otherwise
    own = entry('x', ours, tolerance=around(5.0, percent=1.0), reading=READING, source=OWN)
    assert own.verdict == REACHED and not own.is_read_otherwise


def test_a_choice_among_readings_is_not_as_printed():
    """The value itself chose the reading, so that it is met proves nothing of the print."""
    chosen = entry('x', 1.0, reading=READING, is_choice=True)
    assert chosen.verdict == AS_READ and chosen.is_read_otherwise
    assert entry('x', 5.0, reading=READING, is_choice=True).verdict == NOT_REACHED
    with pytest.raises(ValueError, match='x: a choice among readings, must have a reading'):
        entry('x', 1.0, is_choice=True)


def test_a_contradiction_without_a_reading_is_no_entry():
    with pytest.raises(ValueError, match=r'x: 1 m of the paper is outside the tolerance \(4.9'):
        entry('x', 5.0, tolerance=around(5.0, by=0.1))


@pytest.mark.parametrize('reading', ['as in Fig 5', 'erratum: x', 'erratum 13', 'erratum 13: '])
def test_a_reading_names_its_erratum(reading):
    with pytest.raises(ValueError, match='must begin with erratum N'):
        entry('x', 1.0, reading=reading)


def test_an_empty_tolerance_is_no_entry():
    with pytest.raises(ValueError, match='contains no value'):
        entry('x', 1.0, tolerance=(1.0, math.nan))


def test_a_bar_that_cannot_fail_is_no_entry():
    with pytest.raises(ValueError, match='contains every value'):
        entry('x', 1.0, tolerance=(-math.inf, math.inf))


def test_a_source_is_the_paper_or_our_own():
    with pytest.raises(ValueError, match="source 'Fig 3', must be one of"):
        entry('x', 1.0, source='Fig 3')


def test_the_key_has_the_gains_where_there_are_several():
    assert entry('rise', 1.0).key == 'rise'
    assert entry('rise', 1.0, gains='table_4').key == 'rise.table_4'


def test_an_entry_of_the_paper_copies_place_value_and_unit():
    made = Entry.of('x', statement('stiction'), 2.01, around(2.0, by=0.05), 'rounded')
    assert (made.source, made.where) == (PAPER, 'section 5.1')
    assert (made.paper, made.unit) == (2.0, 'Nm')
    put_in = Entry.given('x', statement('stiction'), 2.01, around(2.0, by=0.05), 'rounded')
    assert (put_in.source, put_in.where, put_in.paper) == (INPUT, 'section 5.1', 2.0)
    words = cell('table_2', 'Valve spool feedback', 'ISA v5')
    assert Entry.of('x', words, 1.0, (0.0, 2.0), 'words').paper == 'Electric'


def test_intervals():
    assert as_printed(statement('torque_rise_time')) == (7.5, 8.5)
    assert around(10.0, by=1.0, percent=10.0) == (8.0, 12.0)
    assert around(-10.0, percent=10.0) == (-11.0, -9.0)
    assert at_least(3.0) == (3.0, math.inf) and at_most(3.0) == (-math.inf, 3.0)


def test_a_figure_that_is_shown_alone_has_its_caption_above_it():
    """In lines that fit its width."""
    figure, _ = stacked('time, s', 'force, N')
    caption = 'Force steps of the knee with the foot on wood and on rubber, as Fig 14. ' * 2
    drawn = Drawing('fig_14', caption, figure).titled()
    lines = drawn.get_suptitle().splitlines()
    assert ' '.join(lines) == caption.strip() and len(lines) == 2
