"""The supply's port: what a node says, how it is shared, what it costs, what is refused (C15)."""

from dataclasses import replace

from isa_ros.core.record import row_record, rows_of
from isa_ros.core.signals import SUPPLY_PORT, SUPPLY_REPLY
from isa_ros.core.units import LPM
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.scripting.run import load
from isa_ros.surroundings.accumulator import accumulator_node, AccumulatorSupply
from isa_ros.surroundings.dump import ValveDump
from isa_ros.surroundings.supply import Supply
from isa_ros.surroundings.supply_port import FedNode, fill_feeds, MovingPort, SupplyPorts
import numpy as np
import pytest
from scripts.measure_supply_port import tree_of
from tests.surroundings.supplied import SHEET

MS = 1_000_000
NODE = FedNode(20e6, 2e-13, 3e-4, 5e-11, 7e-2)
MOVING = replace(SHEET, port=MovingPort())


def feeds_of(flows: list[float], conductances: list[float]) -> np.ndarray:
    """Return the ports of as many actuators, of which all but row 1 are at the node."""
    last, feeds = rows_of(len(flows), SUPPLY_REPLY), rows_of(len(flows), SUPPLY_PORT)
    last['flow'], last['conductance'] = flows, conductances
    fill_feeds(NODE, [row for row in range(len(flows)) if row != 1], last, feeds)
    return feeds


def test_a_port_has_the_node_less_what_all_its_actuators_drew() -> None:
    """C15: row 1 is fed by another supply, and is neither counted nor filled."""
    feeds = feeds_of([1e-5, 9.0, 2e-5], [1e-11, 9.0, 3e-11])
    assert feeds[['elastance', 'trend', 'slope']][0].item() == (1.0 / 2e-13, 7e-2, 5e-11)
    assert feeds['inflow'][[0, 2]].tolist() == [3e-4 - (1e-5 + 2e-5)] * 2
    assert feeds['flow'].tolist() == [1e-5, 0.0, 2e-5]
    assert feeds['elastance'][1] == 0.0


def test_an_actuator_stands_for_as_many_as_its_valve_conducts() -> None:
    """C16: N = sum G / G, at most 3."""
    share = feeds_of([0.0] * 4, [1e-11, 9.0, 2e-11, 1e-11])['share'][[0, 2, 3]]
    assert share.tolist() == pytest.approx([3.0, 2.0, 3.0], rel=1e-12, abs=0.0)


@pytest.mark.parametrize('conductances', [[0.0, 0.0, 0.0], [0.0, 9.0, 1e-11]])
def test_a_shut_valve_stands_for_all(conductances: list[float]) -> None:
    """C16: at most the number of actuators at the node."""
    assert feeds_of([0.0] * 3, conductances)['share'][0] == 2.0


def node_of(plant: Supply) -> FedNode:
    """Return the node of a supply."""
    node: FedNode = accumulator_node(
        row_record(plant.records.supply), row_record(plant.state))
    return node


def inflow(plant: Supply, pressure: float) -> float:
    """Return the node's inflow of a supply at another pressure."""
    plant.state['pressure'] = pressure
    return node_of(plant).inflow


@pytest.mark.parametrize(('pressure', 'changes', 'slope'), [
    (20e6, {}, 0.0), (22.6e6, {}, 24.0 * LPM / 1e6),
    (20e6, {'line_leakage_lpm_per_mpa': 2.0}, 2.0 * LPM / 1e6)], ids=['', 'relief', 'leak'])
def test_a_node_falls_with_its_pressure_by_its_slope(
        pressure: float, changes: dict[str, float], slope: float) -> None:
    """C8: relief and leak are lines, so that the difference over 20 kPa is exact."""
    plant = Supply(replace(MOVING, **changes), MS, 2e-12)
    found = inflow(plant, pressure - 1e4) - inflow(plant, pressure + 1e4)
    plant.state['pressure'] = pressure
    assert node_of(plant).slope == pytest.approx(slope, rel=1e-12, abs=0.0)
    assert found / 2e4 == pytest.approx(slope, rel=1e-6, abs=1e-18)


@pytest.mark.parametrize('opening', [1.0, 0.5])
def test_an_open_dump_is_half_of_its_flow_over_the_pressure(opening: float) -> None:
    """C14: d(K sqrt(P))/dP = Q/(2 P) far above the delta of V5, which is some kPa."""
    plant = Supply(replace(MOVING, dump=ValveDump(
        rated_lpm=60.0, rated_drop_mpa=0.7, time_constant_ms=20.0)), MS, 2e-12)
    plant.state['dump_opening'] = opening
    node = node_of(plant)
    assert node.inflow < 0.0
    assert node.slope == pytest.approx(-0.5 * node.inflow / 20.7e6, rel=1e-6, abs=0.0)


@pytest.mark.parametrize('flow_lpm', [0.0, 6.0])
def test_the_pump_is_inflow_and_trend_of_its_node(flow_lpm: float) -> None:
    """C8: Q and (Q_demand - Q)/T, 0.2 of 0.5 MPa below the set point."""
    plant = Supply(MOVING, MS, 2e-12)
    plant.state['pressure'], plant.state['pump_flow'] = 20.5e6, flow_lpm * LPM
    node = node_of(plant)
    assert node.trend == pytest.approx((0.4 * 12.0 - flow_lpm) * LPM / 0.03, rel=1e-9, abs=0.0)
    assert node.inflow == pytest.approx(flow_lpm * LPM, rel=1e-12, abs=0.0)
    assert node.pressure == 20.5e6


def test_a_supply_that_holds_its_pressure_has_no_node() -> None:
    assert not Supply(SHEET, MS, 2e-12).has_port


def test_a_small_line_is_for_a_moving_port_only() -> None:
    """C over slope: 2e-13 m3/Pa over 1e-9 m3/s/Pa is 0.2 ms, between 80 us and ten ticks."""
    line = {'gas_volume_l': 1e-3, 'bulk_modulus': 1e9, 'relief_lpm_per_mpa': 1.0}
    with pytest.raises(ParameterError, match=r'port: \{kind: moving\}'):
        Supply(replace(SHEET, **line), MS, 1e-9)
    Supply(replace(MOVING, **line), MS, 1e-9)


@pytest.mark.parametrize(('slope', 'changes', 'said'), [
    (1e-8, {}, 'main: capacitance of the line over flow slope = 0.0286 ms, must be >= 0.08 ms '
     '(four plant steps); enlarge line_volume_l'),
    (1e-9, {'relief_lpm_per_mpa': 1e3}, 'main: time constant of relief valve and line = 0.0171 '
     'ms, must be >= 0.05 ms; enlarge line_volume_l or reduce relief_lpm_per_mpa')])
def test_a_line_that_nothing_can_integrate_is_refused(
        slope: float, changes: dict[str, float], said: str) -> None:
    """C16: 2.86e-13 m3/Pa; the gas may be lost, so that it does not count."""
    with pytest.raises(ParameterError) as refused:
        Supply(replace(MOVING, **changes), MS, slope, name='main')
    assert str(refused.value) == said


def test_what_is_paid_is_the_energy_and_the_rest_held() -> None:
    """E1, E9: the held entry moves by what is paid beyond the tick's first pressure."""
    one, other = Supply(MOVING, MS, 2e-12), Supply(MOVING, MS, 2e-12)
    one.advance(1e-6, 0.0, 20.0)
    other.advance(1e-6, 0.0)
    for name, more in (('energy', 20.0 - 20.7), ('held_energy', 20.0 - 20.7)):
        assert float(one.state[name][0] - other.state[name][0]) == pytest.approx(more, rel=1e-9)
    for name in ('pressure', 'drawn', 'stored_energy', 'pump_energy', 'relief_energy'):
        assert one.state[name] == other.state[name]


def test_ports_that_are_not_used_leave_the_pressures_held() -> None:
    """A caller of actuators that hold their pressure pays it."""
    ports, fed = SupplyPorts(2, [Supply(MOVING, MS, 2e-12)]), np.ones(2, SUPPLY_REPLY)
    assert not ports.take(None) and not SupplyPorts(2, []).take(fed)
    assert not ports.answers.tobytes().strip(b'\0')
    assert ports.take(fed) and ports.answers.tobytes() == fed.tobytes()


def test_the_key_has_two_kinds() -> None:
    run, scenario = tree_of(200.0, 'sliding', 'one, the others hold')
    with pytest.raises(ConfigError, match="'sliding', must be one of held, moving"):
        load(run, scenario)


def test_an_old_file_holds_its_pressure() -> None:
    run, scenario = tree_of(200.0, 'held', 'one, the others hold')
    del run['supply']['port']
    run['supply'] |= {'precharge_mpa': 12.0}
    sheet = load(run, scenario).configuration.supplies[0].sheet
    assert isinstance(sheet, AccumulatorSupply) and type(sheet.port).__name__ == 'HeldPort'
