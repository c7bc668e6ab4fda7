"""Responses and characteristics drawn from runs, compared with the data sheets."""

from isa_ros.analysis.report.paper_figures import paper_figure
from isa_ros.analysis.signals.signals import Signals, signals_of
from isa_ros.errors import ConfigError
from isa_ros.scripting.run import load
import numpy as np
import pytest


def simulated(config: str, scenario: str | None, duration: float | None = None) -> Signals:
    """Return the signals of a shipped run."""
    return signals_of(load(config, scenario).simulate(duration))


def curve(figure, row: int, label: str) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of the line whose label begins with ``label``."""
    lines = [line for line in figure.axes[row].lines if line.get_label().startswith(label)]
    assert len(lines) == 1, [line.get_label() for line in figure.axes[row].lines]
    return np.asarray(lines[0].get_xdata()), np.asarray(lines[0].get_ydata())


def near(x: np.ndarray, y: np.ndarray, place: float, width: float) -> np.ndarray:
    """Return the values y within ``width`` of ``place`` on x."""
    found = y[np.abs(x - place) < width]
    assert len(found), f'no point near {place:g}'
    return found


def test_flow_gain_is_figure_5():
    """0.4 l/min at 1 mA and 7.5 at 4 mA of the ULLV, 2.3 l/min per mA of the HRV, both ways."""
    figure = paper_figure('flow_gain', simulated('rig_valve', 'flow_gain'))
    # within 0.1 mA of the place, and the 12 bit converters of pressure and spool: 5 %
    for model, place, slope, flow in (
            ('ullv', 1.0, 0.4, 0.4), ('ullv', 3.0, 2.5, 4.98), ('ullv', -3.0, 2.5, -4.98),
            ('hrv', 1.0, 2.3, 2.3), ('hrv', -1.0, 2.3, -2.3)):
        found = near(*curve(figure, 0, model), place, 0.1)
        assert np.abs(found - flow).max() < 0.1 * slope + 0.05 * abs(flow)


@pytest.mark.slow
def test_valve_response_is_figure_4():
    """-3 dB at 114 Hz of eq 8 and 320 Hz of the HRV, errata 19 and 20, from a chirp of 25 %."""
    figure = paper_figure('valve_response', simulated('rig_valve', 'valve_response'))
    for model, expected in (('ullv', 114.1), ('hrv', 320.0)):
        frequency, gain = curve(figure, 0, model)
        # bins of the averaged spectra are 2 Hz apart
        assert np.interp(3.01, -gain, frequency) == pytest.approx(expected, abs=4.0)


@pytest.mark.slow
def test_leakage_is_figure_6():
    """0.17 and 0.5 l/min at null, 0.06 and 0.28 at full current."""
    figure = paper_figure('leakage', simulated('rig_leakage', 'leakage'))
    for model, at_null, tare in (('ullv', 0.17, 0.06), ('hrv', 0.5, 0.28)):
        x, y = curve(figure, 0, model)
        assert near(x, y, 0.0, 0.01).min() == pytest.approx(at_null, abs=0.03)
        # 1 ml takes 0.03 ml to rise by 20.7 MPa; the high-response valve does so within 0.05 mA,
        # which last 0.06 s: 0.03 l/min, at its fastest twice that
        assert y.max() == pytest.approx(at_null, abs=0.06)
        # at 5 mA the closed lands leak 7 % of their leakage at null
        assert near(x, y, 4.9, 0.1).max() == pytest.approx(tare, abs=0.015)


def test_current_step_shows_both_loops():
    """Section 3.1: the closed loop reaches 5 mA, 10 V on the open coil give 4.17 mA."""
    figure = paper_figure('current_step', simulated('rig_valve', 'current_step'))
    assert figure.get_suptitle() == 'Steps of the current, as Fig 8'
    for row, expected in ((0, 5.0), (1, 10.0 / 2.4)):
        t, current = curve(figure, row, 'current')
        assert current[-1] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize('config, scenario, output', [
    ('rig_rotary', 'torque_bandwidth', 'torque'), ('rig_linear', 'force_bandwidth', 'force')])
def test_bandwidth_at_10_percent_is_50_to_100_hz(config, scenario, output):
    """Section 6: small signals of about 10 % of the rating."""
    figure = paper_figure('bandwidth', simulated(config, scenario))
    assert figure.get_suptitle() == f'Bandwidth of the {output}'
    assert figure.axes[0].get_ylabel() == f'{output} over reference, dB'
    frequency, gain = next((line.get_xdata(), line.get_ydata()) for line in figure.axes[0].lines)
    beyond = frequency > 30.0  # behind the resonance of the torque loop
    assert 50.0 < np.interp(3.01, -gain[beyond], frequency[beyond]) < 100.0


def test_a_run_that_stands_still_has_no_response():
    """One error line instead of an empty figure."""
    with pytest.raises(ConfigError, match='no reference moves'):
        paper_figure('leakage', simulated('rig_leakage', None, 0.01))
