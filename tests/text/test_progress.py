"""Progress on a terminal: one line, with the time spent and left."""

import errno
import io
import threading

from isa_ros.text.progress import counted, repeated, terminal_line, told, underway
import pytest
from tests.text.terminal import Terminal


def shown(steps, **options) -> list[str]:
    """Return what the line showed at (time, done, total, what), each."""
    stream, times = Terminal(), iter([0.0, *(time for time, *_ in steps)])
    report = counted(stream, 'runs', clock=lambda: next(times), **options)
    assert report is not None
    for _, *progress in steps:
        report(*progress)
    return stream.getvalue().split('\r')[1:]


def test_nothing_is_shown_elsewhere():
    assert terminal_line(io.StringIO()) is None
    assert counted(io.StringIO(), 'runs') is None


def test_a_line_is_written_over_and_ends_or_is_erased():
    stream = Terminal()
    line = terminal_line(stream)
    assert line is not None
    line.show('a long text')
    line.show('short')
    line.erase()
    line.end('done')
    assert stream.getvalue() == '\ra long text\x1b[K\rshort\x1b[K\r\x1b[K\rdone\x1b[K\n'


def test_the_time_left_is_what_the_rest_takes_at_the_same_speed():
    """2 of 6 in 4 s: 2 s each, 8 s for the other four."""
    assert shown([(0.0, 0, 6, 'leg'), (4.0, 2, 6, 'rig')]) == [
        '0 of 6 runs, 0 s: leg\x1b[K', '2 of 6 runs, 4 s, 8 s left: rig\x1b[K']


@pytest.mark.parametrize('stays, expected', [
    (False, '\x1b[K'), (True, 'lap: 2 of 2 runs, 7 s\x1b[K\n')])
def test_at_the_end_the_line_is_erased_unless_it_stays(stays, expected):
    first, last = shown([(3.0, 1, 2), (7.0, 2, 2)], of='lap', stays=stays)
    assert first == 'lap: 1 of 2 runs, 3 s, 3 s left\x1b[K'
    assert last == expected


def test_a_piece_is_told_when_it_is_finished():
    """Which its user is once they ask for the next one; without progress they are the same."""
    steps = []
    for piece in told('abc', lambda done, total, what='': steps.append((done, total))):
        steps.append(piece)
    assert steps == ['a', (1, 3), 'b', (2, 3), 'c', (3, 3)]
    assert list(told('abc', None)) == ['a', 'b', 'c']


def test_a_terminal_that_was_closed_ends_no_work():
    """SIGHUP may be ignored, or the work has still to close its files."""
    class Closed(Terminal):
        def write(self, text):
            raise OSError(errno.EIO, 'Input/output error')

    line = terminal_line(Closed())
    assert line is not None
    line.show('half')
    line.end('done')


def test_what_is_under_way_is_shown_until_it_ends_or_fails():
    stream, other = Terminal(), io.StringIO()
    with pytest.raises(ZeroDivisionError), underway(stream, 'reading'), underway(other, 'reading'):
        assert stream.getvalue().endswith('\rreading\033[K')
        raise ZeroDivisionError
    assert stream.getvalue() == '\rreading\033[K\r\033[K' and other.getvalue() == ''


def test_the_time_that_was_spent_is_shown_while_it_is_under_way():
    """As seconds go by, and no more once it has ended."""
    times, shown = iter([0.0, *(1.2 * k for k in range(1, 1000))]), threading.Event()

    class Watched(Terminal):
        def write(self, text):
            if ', 2 s' in text:
                shown.set()
            return super().write(text)
    stream, threads = Watched(), threading.active_count()
    with underway(stream, 'reading', lambda: next(times), period_s=1e-3):
        assert shown.wait(20.0)
    text = stream.getvalue()
    assert text.startswith('\rreading\033[K\rreading, 1 s\033[K\rreading, 2 s\033[K')
    assert text.endswith('\r\033[K') and threading.active_count() == threads


def test_what_is_repeated_ends_with_its_context():
    enough, calls = threading.Event(), []

    def call():
        calls.append(threading.current_thread())
        if len(calls) == 3:
            enough.set()
    with pytest.raises(ZeroDivisionError), repeated(call, 1e-3):
        assert enough.wait(20.0)
        raise ZeroDivisionError
    assert calls[0] is not threading.main_thread() and not calls[0].is_alive()
    with repeated(call, 1e3):
        n = len(calls)
    assert len(calls) == n
