"""Progress on a terminal."""

import io

from isa_ros.run.pacing import RunProgress
from isa_ros.run.terminal import terminal_report
from tests.text.terminal import Terminal


def test_nothing_is_shown_elsewhere():
    assert terminal_report(io.StringIO()) is None


def test_one_line_is_overwritten_until_the_last():
    stream = Terminal()
    report = terminal_report(stream)
    assert report is not None
    report(RunProgress(500_000_000, 1.25, 2.0, False))
    report(RunProgress(3_000_000_000, 1.5, 0.0, True))
    assert stream.getvalue() == (
        '\rt = 0.500 s, 1.25 times real time, 2 s left\x1b[K'
        '\rt = 3.000 s, 1.50 times real time\x1b[K\n')
