"""What absent parts cost: the interval, the calls in turn, and the table of docs/parts.md."""

from pathlib import Path
import re

from isa_ros.bench.child import ROOT
from isa_ros.errors import RunError
import pytest
from scripts import measure_parts_cost as measured

ROW = re.compile(r'\| (.+) \| \d+ \| ([\d.]+) us \| ([\d.]+) \| ([\d.]+) to ([\d.]+) \| (\w+) \|')


def test_an_interval_is_that_of_the_order_statistics() -> None:
    """By tables of the sign test: 6 values need all, of 16 the 4th and the 13th, 12 the 3rd."""
    assert measured.interval([5.0, 3.0, 8.0, 1.0, 4.0, 9.0]) == (1.0, 9.0)
    assert measured.interval([float(k) for k in range(12)][::-1]) == (2.0, 9.0)
    assert measured.interval([float(k) for k in range(16)]) == (3.0, 12.0)
    with pytest.raises(ValueError, match='5 values'):
        measured.interval([1.0, 2.0, 3.0, 4.0, 5.0])


class Counted:
    """A side whose calls cost what it is told; all sides note who is called."""

    def __init__(self, name: str, costs: list[float], called: list[str], digest: str) -> None:
        self.name, self.costs, self.called, self.digest = name, costs, called, digest

    def call(self) -> float:
        self.called.append(self.name)
        return self.costs.pop(0)

    def end(self) -> str:
        return self.digest


def test_sides_are_called_in_turn_and_compared_call_by_call() -> None:
    """A host that slows down from 10 to 40 us leaves the ratio."""
    called: list[str] = []
    old = Counted('old', [10.0, 20.0, 40.0], called, 'bytes')
    new = Counted('new', [11.0, 24.0, 44.0], called, 'bytes')
    assert measured.pair((old, new), 3) == (20.0, pytest.approx(1.1), True)
    assert called == ['new', 'old', 'old', 'new', 'new', 'old']
    other = Counted('new', [11.0], called, 'others')
    assert measured.pair((Counted('old', [10.0], called, 'bytes'), other), 1)[2] is False


@pytest.mark.slow
def test_a_checkout_over_itself_has_the_same_bytes() -> None:
    own = measured.cost(ROOT, 'three ISA v5, moving', pairs=6, rounds=2)
    assert own.is_same and own.pairs == 6
    assert 3.0 < own.before < 3000.0 and own.lowest <= own.ratio <= own.highest


def test_a_side_that_cannot_begin_says_why(tmp_path: Path) -> None:
    side = measured.Side(ROOT, tmp_path / 'none.yaml', 'held', 10)
    with pytest.raises(RunError, match=r'time_ticks\.py: [^$]*none\.yaml'):
        side.call()


def test_the_page_has_every_case_below_one_percent() -> None:
    """Absent parts change no byte, and cost less than 1 % in the median."""
    found = {row[1]: row for row in ROW.finditer(measured.PAGE.read_text(encoding='utf-8'))}
    assert set(found) == set(measured.CASES)
    for row in found.values():
        ratio, lowest, highest = (float(row[k]) for k in (3, 4, 5))
        assert lowest <= ratio <= highest
        assert ratio < 1.01
        assert row[6] == 'same'
