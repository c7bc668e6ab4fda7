"""A run of the command line: what is printed of it, before, during and after."""

from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager
import errno
from functools import wraps
import sys
from typing import TYPE_CHECKING

from isa_ros.errors import one_line
from isa_ros.run.options import Request

if TYPE_CHECKING:
    from isa_ros.run.session import Report, Session

Command = Callable[[Namespace], bool]
PAGE = 'report.html'
"""Of a report beside its bag."""


def simulating(command: Command) -> Command:
    """Return a command that reports when kernels are compiled."""
    @wraps(command)
    def reporting(options: Namespace) -> bool:
        from isa_ros.run.compiling import reported_compilation
        with reported_compilation('isa'):
            return command(options)
    return reporting


def record(request: Request) -> 'Session':
    """Run, print the paths of its bags and what happened, also after an error."""
    from isa_ros.run.session import prepare
    session = prepare(request)

    def run(report: 'Report | None') -> None:
        # The import of rclpy takes a third of a second; do it after the options are checked.
        from isa_ros.nodes.bringup import run_session
        run_session(session, report)
    recorded(session, run)
    return session


def recorded(session: 'Session', run: 'Callable[[Report | None], None]') -> None:
    """Print the warnings of a session, run it, and print the paths of its bags."""
    from isa_ros.run.terminal import terminal_report
    for line in session.warnings:
        print_line(line)
    try:
        run(terminal_report(sys.stderr))
    finally:
        with _even_without_terminal():
            for bag in session.bags:
                print(bag)
                if (bag / PAGE).is_file():
                    print_line(f'{bag / PAGE}: is of the bag that was replaced; isa report {bag} '
                               'writes it anew')
            for line in session.lines:
                print_line(line)
            if session.pace.shortfall:
                print_line(session.pace.shortfall)


def print_line(line: str) -> None:
    """Print a line about a run for the user."""
    print(one_line(f'isa: {line}'), file=sys.stderr, flush=True)


@contextmanager
def _even_without_terminal() -> Iterator[None]:
    """Print nothing on a terminal that was closed: the run ends by its SIGHUP."""
    try:
        yield
    except OSError as error:
        if error.errno != errno.EIO:
            raise
