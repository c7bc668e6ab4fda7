"""Rows that are measured in this process: positive, and consistent with each other."""

from isa_ros.bench import plant, tick
from isa_ros.bench.parts import divided, misfits
from isa_ros.bench.row import Row
from isa_ros.core.timebase import NS_PER_SECOND
import pytest


def test_parts_of_a_tick_add_up(monkeypatch):
    """Every part has a time; with the remainder, the shares are of the whole."""
    monkeypatch.setattr(tick, 'TICKS', 20)
    whole, *parts = tick.tick_parts()
    assert all(row.value > 0.0 for row in (whole, *parts[:-1]))
    assert sum(row.ratio for row in parts) == pytest.approx(1.0)
    assert (parts[-1].name, parts[-1].most_share) == ('of it not covered', tick.SHARE)


def test_messages_of_each_second_are_packed_once_a_second(monkeypatch):
    """In 1500 ticks of 1 ms twice at most, whatever tick they begin with."""
    monkeypatch.setattr(tick, 'TICKS', 1500)
    packed = []

    class Packer:
        def pack(self, t_ns, tick_start_ns, tuned):
            packed.append((t_ns, tick_start_ns))

        def all_messages(self):
            pass
    tick.packing(Packer(), 1_000_000)()
    assert len(packed) == 1500 and all(end - start == 1_000_000 for end, start in packed)
    assert sum(end % NS_PER_SECOND == 0 for end, _ in packed) == 1


@pytest.mark.parametrize('spent, is_refused', [(80e-6, False), (70e-6, True), (130e-6, True)])
def test_parts_that_leave_too_much_are_refused(spent, is_refused):
    """Of 100 us a quarter may be left, or be too much."""
    rows = divided(Row('a tick', 100.0, 'us'), {'kernels': 10e-6, 'rest': spent - 10e-6}, 0.25)
    assert [row.part_of for row in rows] == ['a tick'] * 3
    assert rows[-1].value == pytest.approx(100.0 - 1e6 * spent)
    assert rows[0].ratio == pytest.approx(0.1)
    lines = misfits(rows)
    assert len(lines) == is_refused
    assert all('must be within 25%' in line for line in lines)


def test_error_of_the_cylinder_stands_beside_its_speed(monkeypatch):
    """Against a finer solution, in metres, and as a ratio to the nanometre."""
    monkeypatch.setattr(plant, 'HOLDS', 200)
    speed, error = plant.cylinder_rows()[1:]
    assert speed.value > 0.0 and speed.ratio > 0.0
    assert 0.0 < error.value < 1e-9
    assert error.ratio == pytest.approx(1e-9 / error.value)
