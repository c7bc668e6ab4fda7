"""What the report shows of cushions and circuits."""

from pathlib import Path

import isa_ros
from isa_ros.analysis.report.energy import energy_text, PARTS_LEGEND
from isa_ros.analysis.report.figures import actuator_figure, circuit_figure, figures
from isa_ros.analysis.report.report import extremes, write_report
from isa_ros.analysis.signals.signals import read_signals, Signals, signals_of
import numpy as np
import pytest


@pytest.fixture(scope='module')
def station() -> isa_ros.Result:
    """Return a run in which the emergency stop dumps the accumulators."""
    return isa_ros.load('pump_station', duration=0.3).simulate(
        faults=[{'t_s': 0.02, 'supply': 'station', 'set': {'dump.opened': 1}}])


def curves(ax: object) -> dict[str, np.ndarray]:
    return {line.get_label(): line.get_ydata() for line in ax.get_lines()}


def test_a_circuit_has_one_figure_with_pressures_and_temperatures(
        station: isa_ros.Result) -> None:
    signals = signals_of(station)
    drawn = figures(signals)
    assert list(drawn) == ['left', 'right', 'clamp', 'station']
    pressure, back, gas = (curves(ax) for ax in drawn['station'].axes)
    assert list(pressure) == ['gallery', 'stored', 'press', 'branch', 'tool']
    assert list(back) == ['drain']
    for name, values in {**pressure, **back}.items():
        assert (values == station[f'station/{name}.pressure'] / 1e6).all(), name
    assert list(gas) == ['buffer', 'tool_buffer']
    assert (gas['buffer'] == station['station/buffer.gas_temperature']).all()
    assert gas['buffer'][-1] < 10.0 < gas['buffer'][0]
    labels = [ax.get_ylabel() for ax in drawn['station'].axes]
    assert labels == [
        'pressure, MPa gauge', 'return side, MPa gauge', 'temperature of gas, celsius']


def test_axes_without_curves_are_left_out(station: isa_ros.Result) -> None:
    all_of_it = signals_of(station)
    supply, = all_of_it.run.supplies
    for kept, n_curves in (('gas_temperature', 2), ('tool.pressure', 1), ('drain.pressure', 1)):
        some = Signals(all_of_it.run, {
            name: all_of_it.over_time(name) for name in all_of_it
            if name.endswith(kept)}, all_of_it.time, 'some')
        ax, = circuit_figure(supply, some).axes
        assert len(ax.get_lines()) == n_curves
        begin = {'gas_temperature': 'temp', 'tool.pressure': 'pressure'}.get(kept, 'return side')
        assert ax.get_ylabel().startswith(begin)
    none = Signals(all_of_it.run, {}, all_of_it.time, 'none')
    assert 'station' not in figures(none)


def test_the_page_has_its_figure_and_its_extremes(
        station: isa_ros.Result, tmp_path: Path) -> None:
    bag = station.save(tmp_path / 'bag')
    written = write_report(bag, tmp_path / 'page.html')
    assert 'page_station.png' in [path.name for path in written]
    assert 'below 0 heat that gas has taken up' in written[0].read_text()
    assert energy_text(bag).endswith(PARTS_LEGEND)
    rows = {name: (low, high, unit) for name, low, high, unit in extremes(read_signals(bag))}
    press = station['station/press.pressure'] / 1e6
    assert rows['station/press pressure'] == (
        pytest.approx(press.min()), pytest.approx(press.max()), 'MPa gauge')
    gas = station['station/buffer.gas_temperature']
    assert rows['station/buffer gas temperature'] == (gas.min(), gas.max(), 'celsius')


def test_other_supplies_have_no_figure() -> None:
    signals = signals_of(isa_ros.load('leg', duration=0.002).simulate())
    assert list(figures(signals)) == ['leg', 'haa', 'hfe', 'kfe']


def test_a_cushion_is_drawn_while_its_spear_is_in() -> None:
    """The press begins 5 mm before its end, and leaves the cushion of 25 mm."""
    result = isa_ros.load('press', 'press_stroke', duration=0.3).simulate()
    signals = signals_of(result)
    own, = signals.run.actuators
    _, _, pressure, _ = actuator_figure(own, signals).axes
    drawn, true = curves(pressure)['cushion'], result['slide.cushion_pressure']
    assert list(curves(pressure)) == ['A', 'B', 'supply', 'cushion']
    assert 0 < (true == 0.0).sum() < len(true) and (np.isnan(drawn) == (true == 0.0)).all()
    assert np.nanmax(drawn) * 1e6 == pytest.approx(true.max())
    rows = {name: (low, high) for name, low, high, _ in extremes(signals)}
    assert rows['slide cushion pressure'] == (0.0, pytest.approx(true.max() / 1e6))


def test_pressures_of_hoses_are_said_to_be_those() -> None:
    """The sensors are in the valve block."""
    for name, expected in (('rig_hoses', ['hose A', 'hose B', 'supply']),
                           ('rig_cylinder', ['A', 'B', 'supply'])):
        signals = signals_of(isa_ros.load(name, duration=0.002).simulate())
        own, = signals.run.actuators
        assert list(curves(actuator_figure(own, signals).axes[2])) == expected


def test_without_one_there_is_no_curve() -> None:
    signals = signals_of(isa_ros.load('rig_linear', duration=0.01).simulate())
    own, = signals.run.actuators
    assert list(curves(actuator_figure(own, signals).axes[2])) == ['A', 'B', 'supply']
    assert not any('cushion' in name for name, *_ in extremes(signals))
