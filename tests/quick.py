"""
What `./isa test --quick` leaves out, so that it takes about 3 minutes of two idle cores.

The kernels are compiled already. Left out are tests marked slow, and those that `quick.txt` names
by folder: they take more than 0.3 s of a core, 8 in 100 of the tests that are not slow and two
thirds of their time. A line of it that begins with `+` is never left out: one test of each kind
that nothing shorter guards, as processes, a restored run or a real master. To measure anew:

    ./isa test -n 0 -m 'not slow and not linter' --junitxml=build/times.xml
    python -m tests.quick build/times.xml

A fixture that several tests share is made by the first of them. Without that one the next makes it
and takes as long, until what is left is measured too and nothing is added:

    ./isa test --quick -n 0 -m 'not linter' --junitxml=build/times.xml
    python -m tests.quick --more build/times.xml
"""

from argparse import ArgumentParser
from collections.abc import Iterator, Mapping
import math
from pathlib import Path
from xml.etree import ElementTree

import pytest

FILE = Path(__file__).with_suffix('.txt')
LONGEST_S = 0.3


def name_of(nodeid: str) -> str:
    """Return folder, or file outside of one, and function: they stay when a file is split."""
    path, _, test = nodeid.partition('::')
    return f'{path.removesuffix(".py").split("/")[1]} {test.partition("[")[0]}'


def left_out() -> set[str]:
    """Return the names of the tests that are not slow and left out."""
    return {line for line in FILE.read_text(encoding='utf-8').splitlines() if line[0] != '+'}


def is_quick(item: pytest.Item, names: set[str]) -> bool:
    """Return whether a test is run; ``names`` are `left_out`."""
    return item.get_closest_marker('slow') is None and name_of(item.nodeid) not in names


def times(report: Path) -> Iterator[tuple[str, float]]:
    """Yield the name of each test of a JUnit report, and how long it took in seconds."""
    for case in ElementTree.parse(report).iter('testcase'):
        path = case.attrib['classname'].replace('.', '/')
        yield name_of(f'{path}::{case.attrib["name"]}'), float(case.attrib['time'])


def text_of(spent: Mapping[str, float], kept: set[str]) -> str:
    """Return the lines of `FILE` for seconds by name; those that are ``kept`` begin with `+`."""
    names = {name for name, seconds in spent.items() if seconds > LONGEST_S} - {
        line[1:] for line in kept}
    return '\n'.join([*sorted(kept), *sorted(names), ''])


def main(report: Path, *, is_more: bool = False) -> None:
    """Write `FILE` anew from a report, or add to it; what is never left out stays."""
    spent = dict.fromkeys(left_out(), math.inf) if is_more else {}
    for name, seconds in times(report):
        spent[name] = max(seconds, spent.get(name, 0.0))
    kept = {line for line in FILE.read_text(encoding='utf-8').splitlines() if line[0] == '+'}
    FILE.write_text(text_of(spent, kept), encoding='utf-8')


if __name__ == '__main__':
    parser = ArgumentParser(prog='python -m tests.quick')
    parser.add_argument('report', type=Path, help='of pytest, --junitxml')
    parser.add_argument('--more', action='store_true', help='add to what is left out')
    given = parser.parse_args()
    main(given.report, is_more=given.more)
