"""What the report shows of cushions and circuits."""

from pathlib import Path

import isa_ros
from isa_ros.analysis.report.actuator_panels import actuator_group
from isa_ros.analysis.report.circuit_panels import circuit_group
from isa_ros.analysis.report.energy import PARTS_LEGEND, recorded_accounts, text_of
from isa_ros.analysis.report.extremes import extremes
from isa_ros.analysis.report.groups import groups_of
from isa_ros.analysis.report.panels import Group, Panel
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.analysis.signals.signals import read_signals, Signals, signals_of
from isa_ros.bag.reader import Bag
import numpy as np
import pytest


@pytest.fixture(scope='module')
def station() -> isa_ros.Result:
    """Return a run in which the emergency stop dumps the accumulators."""
    return isa_ros.load('pump_station', duration=0.3).simulate(
        faults=[{'t_s': 0.02, 'supply': 'station', 'set': {'dump.opened': 1}}])


def curves(panel: Panel) -> dict[str, np.ndarray]:
    return {own.label: own.signal.values / panel.scale for own in panel.curves}


def panel_of(group: Group, title: str) -> Panel:
    found, = (own for own in group.panels if own.title == title)
    return found


def test_a_circuit_has_one_figure_with_pressures_and_temperatures(
        station: isa_ros.Result) -> None:
    signals = signals_of(station)
    drawn = {own.name: own for own in groups_of(signals)}
    assert list(drawn) == ['left', 'right', 'clamp', 'station']
    pressure, back, gas = (curves(own) for own in drawn['station'].panels)
    assert list(pressure) == ['gallery', 'stored', 'press', 'branch', 'tool']
    assert list(back) == ['drain']
    for name, values in {**pressure, **back}.items():
        assert (values == station[f'station/{name}.pressure'] / 1e6).all(), name
    assert list(gas) == ['buffer', 'tool_buffer']
    assert (gas['buffer'] == station['station/buffer.gas_temperature']).all()
    assert gas['buffer'][-1] < 10.0 < gas['buffer'][0]
    assert [own.label for own in drawn['station'].panels] == [
        'pressure, MPa gauge', 'return side, MPa gauge', 'temperature of gas, celsius']
    assert drawn['station'].sources == ('station',)


def test_axes_without_curves_are_left_out(station: isa_ros.Result) -> None:
    all_of_it = signals_of(station)
    supply, = all_of_it.run.supplies
    for kept, n_curves in (('gas_temperature', 2), ('tool.pressure', 1), ('drain.pressure', 1)):
        some = Signals(all_of_it.run, {
            name: all_of_it.over_time(name) for name in all_of_it
            if name.endswith(kept)}, all_of_it.time, 'some')
        panel, = circuit_group(supply, some).panels
        assert len(panel.curves) == n_curves
        begin = {'gas_temperature': 'temp', 'tool.pressure': 'pressure'}.get(kept, 'return side')
        assert panel.title.startswith(begin)
    none = Signals(all_of_it.run, {}, all_of_it.time, 'none')
    assert 'station' not in [own.name for own in groups_of(none)]


def test_the_page_has_its_figure_and_its_extremes(
        station: isa_ros.Result, tmp_path: Path) -> None:
    bag = station.save(tmp_path / 'bag')
    written = write_report(recorded(bag), tmp_path / 'page.html')
    assert 'page_station.png' in [path.name for path in written]
    assert 'more than at t = 0; return: lost on the way' in written[0].read_text()
    assert text_of(recorded_accounts(Bag(bag))).endswith(PARTS_LEGEND)
    rows = {name: (low, high, unit) for name, low, high, unit in extremes(read_signals(bag))}
    press = station['station/press.pressure'] / 1e6
    assert rows['station/press pressure'] == (
        pytest.approx(press.min()), pytest.approx(press.max()), 'MPa gauge')
    gas = station['station/buffer.gas_temperature']
    assert rows['station/buffer gas temperature'] == (gas.min(), gas.max(), 'celsius')


def test_other_supplies_have_no_figure() -> None:
    signals = signals_of(isa_ros.load('leg', duration=0.002).simulate())
    assert [own.name for own in groups_of(signals)] == ['leg', 'haa', 'hfe', 'kfe']


def test_a_cushion_is_drawn_while_its_spear_is_in() -> None:
    """The press begins 5 mm before its end, and leaves the cushion of 25 mm."""
    result = isa_ros.load('press', 'press_stroke', duration=0.3).simulate()
    signals = signals_of(result)
    own, = signals.run.actuators
    pressure = panel_of(actuator_group(own, signals), 'pressure')
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
        assert list(curves(panel_of(actuator_group(own, signals), 'pressure'))) == expected


def test_without_one_there_is_no_curve() -> None:
    signals = signals_of(isa_ros.load('rig_linear', duration=0.01).simulate())
    own, = signals.run.actuators
    assert list(curves(panel_of(actuator_group(own, signals), 'pressure'))) == [
        'A', 'B', 'supply']
    assert not any('cushion' in name for name, *_ in extremes(signals))
