"""Rows that are measured in this process: positive, and consistent with each other."""

from isa_ros.bench import plant, tick
import pytest


def test_parts_of_a_tick_add_up(monkeypatch):
    """Every part has a time, and the shares are of their sum."""
    monkeypatch.setattr(tick, 'TICKS', 20)
    rows = tick.tick_parts()
    assert all(row.value > 0.0 for row in rows)
    assert sum(row.ratio for row in rows) == pytest.approx(1.0)


def test_error_of_the_cylinder_stands_beside_its_speed(monkeypatch):
    """Against a finer solution, in metres, and as a ratio to the nanometre."""
    monkeypatch.setattr(plant, 'HOLDS', 200)
    speed, error = plant.cylinder_rows()[1:]
    assert speed.value > 0.0 and speed.ratio > 0.0
    assert 0.0 < error.value < 1e-9
    assert error.ratio == pytest.approx(1e-9 / error.value)
