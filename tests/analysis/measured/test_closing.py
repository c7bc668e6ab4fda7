"""The search for free parameters, over machines that are formulas."""

from collections.abc import Callable, Mapping

from isa_ros.analysis.measured import closing
from isa_ros.analysis.measured.closing import (
    _simulations, Closed, closed, delay_left, Free, shifted)
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.search import Minimum
from isa_ros.analysis.signals.signals import Signal
from isa_ros.errors import ParameterError
import numpy as np
import pytest

T = np.arange(0.0, 3.0, 0.01)
SWING = np.sin(2.0 * np.pi * 0.7 * T)


def free(start: float = 1.0, size: float = 1.0) -> Free:
    return Free('load.inertia', start, 0.1, 10.0, size, 'kg')


def found_from(
        monkeypatch: pytest.MonkeyPatch, machine: Callable[[float], np.ndarray],
        true: np.ndarray) -> tuple[Closed, list[int]]:
    """Return the parameter with which a machine comes closest, and the runs that were told."""
    def played(run: Mapping[str, float], *given: object) -> dict[str, Signal]:
        return {'position': Signal(T, machine(run['load.inertia']))}
    monkeypatch.setattr(closing, 'changed', lambda run, name, values: values)
    monkeypatch.setattr(closing, 'played', played)
    runs: list[int] = []
    found, = closed(None, 'ram', Measurement('m', {'position': Signal(T, true)}), [free()], 3.0,
                    runs.append)
    return found, runs


def test_a_parameter_is_found_and_each_run_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    found, runs = found_from(monkeypatch, lambda m: m * SWING, 2.7 * SWING)
    assert found.value == pytest.approx(2.7, rel=1e-6)
    assert len(runs) > 3 and runs == list(range(1, len(runs) + 1))


def test_the_search_leaves_values_that_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the first difference reaches into them: they are worse than the start."""
    def machine(m: float) -> np.ndarray:
        if m > 1.05:
            raise ParameterError('load.inertia')
        return m * SWING
    assert found_from(monkeypatch, machine, 0.6 * SWING)[0].value == pytest.approx(0.6, rel=1e-3)


def test_a_start_that_is_refused_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(m: float) -> np.ndarray:
        raise ParameterError(f'load.inertia = {m:g}')
    with pytest.raises(ParameterError, match='load.inertia = 1'):
        found_from(monkeypatch, refused, SWING)


@pytest.mark.parametrize(('value', 'size', 'half_width', 'expected'), [
    (-4.0, 1.0, 1.9, True), (-4.0, 1.0, 2.1, False), (0.5, 2.0, 0.9, True),
    (0.5, 2.0, 1.1, False)])
def test_a_wide_interval_determines_nothing(
        value: float, size: float, half_width: float, expected: bool) -> None:
    """Half of it is compared with half the estimate, or half its size where this is larger."""
    assert Closed(free(size=size), value, half_width).is_determined is expected


def test_a_measurement_is_shifted_to_the_clock_of_its_commands() -> None:
    """What comes late is moved back by the delay, a clock that is fast slowed."""
    signal = Signal(np.array([0.0, 2.0]), np.array([3.0, 5.0]))
    found = shifted(signal, {'clock_ppm': 500.0, 'delay_ms': 20.0})
    assert found.t == pytest.approx([-0.02, 2.0 / 1.0005 - 0.02], abs=1e-12)
    assert found.values is signal.values


def test_residuals_may_hang_together_over_40_samples_of_10_ms(
        monkeypatch: pytest.MonkeyPatch) -> None:
    """0.4 s."""
    seen = []

    def searched(residuals: object, start: np.ndarray, box: object, lags: int) -> Minimum:
        seen.append(lags)
        return Minimum(start, start, 0.0)
    monkeypatch.setattr(closing, 'searched', searched)
    closed(None, 'ram', Measurement('m', {'position': Signal(T, SWING)}), [free()], 3.0)
    assert seen == [40]


DELAY = Free('delay_ms', 0.0, -50.0, 50.0, 1.0, 'ms')


def late(delay: float) -> Measurement:
    """Return a swing of 1.3 times the size, late by a delay in s, with little noise."""
    noise = np.random.default_rng(3).normal(0.0, 1e-3, len(T))
    return Measurement('m', {'position': Signal(T, 1.3 * np.sin(
        2.0 * np.pi * 0.7 * (T - delay)) + noise)})


@pytest.fixture
def swing(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Play a swing of a size, and return the sizes that were played."""
    sizes: list[float] = []

    def played(run: Mapping[str, float], *given: object) -> dict[str, Signal]:
        sizes.append(run.get('load.inertia', 1.3))
        return {'position': Signal(T, sizes[-1] * SWING)}
    monkeypatch.setattr(closing, 'changed', lambda run, name, values: values)
    monkeypatch.setattr(closing, 'played', played)
    return sizes


def test_a_free_delay_costs_few_runs(swing: list[float]) -> None:
    """Of most of its slopes the run is one of the last; the delay is a sample."""
    runs: list[int] = []
    size, delay = closed(None, 'ram', late(0.01), [free(), DELAY], 3.0, runs.append)
    assert runs == list(range(1, len(swing) + 1)) and len(swing) < 1.3 * len(set(swing))
    assert abs(size.value - 1.3) < size.half_width < 0.1
    assert abs(delay.value - 10.0) < 0.1 and delay.half_width < 0.1


def test_runs_that_differ_in_the_measurement_alone_are_one() -> None:
    """As many of the last ones as are to be kept; each that is simulated is told."""
    played: list[Mapping[str, float]] = []
    runs: list[int] = []

    def simulated(values: Mapping[str, float]) -> dict[str, Signal]:
        played.append(values)
        return {}
    of = _simulations(simulated, runs.append, 2)
    for inertia, delay in (
            (5.0, 0.0), (6.0, 0.0), (5.0, 1.0), (7.0, 1.0), (5.0, -1.0), (6.0, 0.0)):
        of({'load.inertia': inertia, 'delay_ms': delay, 'clock_ppm': -delay})
    assert [own['load.inertia'] for own in played] == [5.0, 6.0, 7.0, 6.0]
    assert runs == [1, 2, 3, 4] and all(len(own) == 1 for own in played)


@pytest.mark.parametrize(('delay_ms', 'is_late'), [
    (0.0, False), (12.0, True), (-12.0, True), (0.1, False)])
def test_a_delay_that_is_left_is_found_by_one_run(
        monkeypatch: pytest.MonkeyPatch, swing: list[float], delay_ms: float, is_late: bool
        ) -> None:
    monkeypatch.setattr(closing, 'free_of', lambda run, name, keys: [DELAY])
    found = delay_left({}, 'ram', late(1e-3 * delay_ms), 3.0)
    assert len(swing) == 1 and bool(found) is is_late
    assert not found or found.value == pytest.approx(delay_ms, rel=0.01)


def test_an_output_of_one_sample_has_no_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of a bag whose command is longer: the others', or the most residuals, say how often."""
    seen = []

    def searched(residuals: Callable[[np.ndarray], np.ndarray], start: np.ndarray, box: object,
                 lags: int) -> Minimum:
        seen.append(residuals(start).shape)
        return Minimum(start, start, 0.0)
    monkeypatch.setattr(closing, 'searched', searched)
    monkeypatch.setattr(closing, 'changed', lambda run, name, values: values)
    one = Signal(np.zeros(1), np.zeros(1))
    monkeypatch.setattr(closing, 'played', lambda run, *given: {'force': one, 'position': one})
    several = Signal(T, SWING)
    for other in (one, several):
        closed(None, 'ram', Measurement('m', {'force': one, 'position': other}), [free()], 2.0)
    assert seen == [(2, closing.POINTS), (2, 200)]
