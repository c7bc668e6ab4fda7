"""What swings: from which size on, how large and how fast, whatever is beside it."""

from isa_ros.analysis.signals.swing import Swing, swing
import numpy as np
import pytest

FINE = np.arange(1001) * 1e-3


def swing_at_end(values: np.ndarray) -> Swing:
    """Return the swing of 1 and more in the last tenth of a second."""
    return swing(FINE[900:], values[900:], 1.0)


@pytest.mark.parametrize('phase', np.linspace(0.0, 2.0 * np.pi, 19))
def test_a_sine_is_told_from_its_bound_on_wherever_it_begins(phase):
    """With 3 periods in the last tenth; with 1.4 of them never."""
    def told(amplitude, hertz=30.0):
        sine = amplitude * np.sin(2.0 * np.pi * hertz * FINE + phase)
        return swing_at_end(sine)
    assert told(0.99) == told(10.0, 14.0) == (0.0, 0.0)
    for amplitude in (1.02, 1.5, 1.95, 40.0):
        size, hertz = told(amplitude)
        assert size == pytest.approx(amplitude, rel=0.01)
        assert hertz == pytest.approx(30.0, rel=0.05)


def test_what_is_faster_and_smaller_does_not_hide_a_swing():
    """3 of 200 Hz on 10 of 20 Hz; one that dies away has ended."""
    sine = 10.0 * np.sin(2.0 * np.pi * 20.0 * FINE)
    size, hertz = swing_at_end(sine + 3.0 * np.sin(2.0 * np.pi * 200.0 * FINE))
    assert 10.0 < size < 13.0 and hertz == pytest.approx(20.0, rel=0.05)
    dying = np.where(FINE < 0.9, 0.0, np.exp((0.9 - FINE) / 0.015) * sine)
    assert swing_at_end(dying) == (0.0, 0.0)


@pytest.mark.parametrize('phase', np.linspace(0.0, 2.0 * np.pi, 9))
@pytest.mark.parametrize(('hertz', 'drift'), [(30.0, 40.0), (25.0, 40.0), (50.0, -100.0)])
def test_a_swing_beside_a_drift_is_as_large_wherever_it_begins(hertz, drift, phase):
    """Of a sine: a way up is longer by the drift of half a period, a way down shorter."""
    sine = 10.0 * np.sin(2.0 * np.pi * hertz * FINE + phase)
    size, found = swing_at_end(sine + 10.0 * drift * FINE)
    assert size == pytest.approx(10.0, rel=0.06) and found == pytest.approx(hertz, rel=0.15)
