"""What is kept of very many samples."""

from isa_ros.analysis.report import document
from isa_ros.analysis.report.document import Shown, Span, thinning_of
from isa_ros.analysis.report.marks import Marks
from isa_ros.analysis.report.panels import Curve, Group, Panel
from isa_ros.analysis.report.thinning import (
    AROUND, extreme_places, MOST_EVENTS, SignalThinning, thinning_for)
from isa_ros.analysis.signals.signals import Signal
from isa_ros.run.events import Event
import numpy as np
import pytest

T = np.arange(100_001) * 1e-3


def test_few_samples_are_all_kept():
    assert extreme_places(T[:4000], 2000).tolist() == list(range(4000))


def test_of_many_samples_every_peak_is_kept():
    """A spike of one sample up, one down, a gap, and the last sample."""
    values = np.sin(T)
    values[[777, 40_003]] = 9.0, -7.0
    values[60_000:60_500] = np.nan
    values[-1] = 5.0
    at = extreme_places(values, 2000)
    assert len(at) <= 4001 and (np.diff(at) > 0).all()
    assert {777, 40_003, 100_000} <= set(at.tolist())
    assert np.isnan(values[at]).any()
    size = 51       # 100 001 samples in at most 2000 parts
    for begin in (0, 51 * 300, 51 * 1100):
        part = values[begin:begin + size]
        kept = values[at[(at >= begin) & (at < begin + size)]]
        assert (kept.min(), kept.max()) == (part.min(), part.max())


def test_a_curve_reaches_the_end_of_the_run():
    """Also where its last sample is no extreme."""
    values = np.append(np.tile([0.0, 1.0], 50_000), 0.5)
    assert extreme_places(values, 2000)[-1] == 100_000


def test_around_events_all_samples_are_kept():
    kept = SignalThinning(10, [20.0, 99.9]).thinned(Signal(T, T))
    for t_s in (20.0, 99.9):
        near = kept.t[np.abs(kept.t - t_s) < AROUND - 1e-9]
        assert len(near) == ((T > t_s - AROUND + 1e-9) & (T < t_s + AROUND - 1e-9)).sum()
    assert len(kept.t) < 20 + 2 * 502 and np.array_equal(kept.t, kept.values)


def test_only_too_many_samples_are_thinned():
    assert thinning_for(1000, 3, 1000, []) is None
    assert thinning_for(1_000_001, 5, 1_000_000, [1.0]) == SignalThinning(100_000, [1.0])
    assert thinning_for(10 ** 9, 10 ** 6, 1000, []) == SignalThinning(1000, [])
    events = [float(k) for k in range(MOST_EVENTS + 5)]
    found = thinning_for(2000, 1, 1000, events)
    assert found is not None and found.events == events[:MOST_EVENTS]


def test_a_page_of_too_many_samples_says_so(monkeypatch: pytest.MonkeyPatch):
    """It is smaller, and keeps what is around the event."""
    group = Group('ram', 'ram', [Panel('force', 'N', 1.0, [
        Curve('measured', Signal(T, np.random.default_rng(2).standard_normal(len(T))))], '')],
        ('ram',))
    shown = [Shown(group, Marks([], [Event(3.0, 'ram', 'trip', 'overload')]))]
    whole = document.document('a', '', shown, Span(0.0, 100.0, 1e-3))
    assert thinning_of(shown) is None and 'Too many samples' not in whole
    monkeypatch.setattr(document, 'MOST_SAMPLES', 4000)
    less = document.document('a', '', shown, Span(0.0, 100.0, 1e-3))
    assert thinning_of(shown) == SignalThinning(2000, [3.0])
    assert 'in each of 2000 parts of the run' in less and len(less) < len(whole) - 50_000
