"""Warnings name the line of the code that called isa_ros, however deep they are."""

from collections.abc import Callable
from pathlib import Path

import isa_ros
from isa_ros.core.caller import warn
import pytest

INSIDE = str(Path(isa_ros.__file__).parent / 'tick' / 'deep.py')


def within(called: Callable[[], object]) -> Callable[[], object]:
    """Return a function whose code is of isa_ros and calls another one."""
    names: dict[str, Callable[[], object]] = {'called': called}
    exec(compile('def own():\n    return called()\n', INSIDE, 'exec'), names)
    return names['own']


def test_a_warning_is_of_the_nearest_line_outside() -> None:
    for call in (lambda: warn('far'), within(lambda: warn('far')),
                 within(within(within(lambda: None and warn('') or warn('far'))))):
        with pytest.warns(UserWarning, match='^far$') as caught:
            call()
        assert [own.filename for own in caught] == [__file__]


def test_lines_of_isa_ros_in_between_are_passed() -> None:
    """The warning is of this call, whose line is known, and has its category."""
    names: dict[str, object] = {'warn': warn}
    exec(compile('def own():\n    warn("far", RuntimeWarning)\n', INSIDE, 'exec'), names)
    deep = within(within(names['own']))     # type: ignore[arg-type]
    with pytest.warns(RuntimeWarning, match='^far$') as caught:
        deep()
    line = test_lines_of_isa_ros_in_between_are_passed.__code__.co_firstlineno + 6
    assert (caught[0].filename, caught[0].lineno) == (__file__, line)
