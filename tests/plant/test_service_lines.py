"""What the lines of both chambers share: the flow that keeps a drop, and whose pilot is whose."""

from isa_ros.plant.service_lines import even_flow, held_flow
import pytest
from tests.actuator.hosed_cylinder import COUNTERBALANCE, hosed

HOSE, CHAMBER = 3e13, 8e13      # elastances, Pa/m3


@pytest.mark.parametrize(('net', 'gained'), [(2e-4, 0.0), (0.0, 3e-4), (-1e-4, 2e-4)])
def test_an_even_flow_moves_both_pressures_alike(net, gained):
    """C42: what a hose gets less the flow, and what its chamber gains with it."""
    flow = even_flow(net, gained, HOSE, CHAMBER)
    assert HOSE * (net - flow) == pytest.approx(CHAMBER * (gained + flow), rel=1e-12, abs=0.0)
    assert even_flow(net, gained, 0.0, 0.0) == 0.0
    assert flow == even_flow.py_func(net, gained, HOSE, CHAMBER)


@pytest.mark.parametrize('side', ['a', 'b'])
def test_the_other_hose_is_the_pilot(side):
    """V40, V43: of 8 MPa held above 1 MPa in its own hose, 10 MPa in the other one open it."""
    other = 'b' if side == 'a' else 'a'
    for pilot, opens in ((10e6, True), (1e6, False)):
        cylinder = hosed(**{f'holding_{side}': COUNTERBALANCE})
        lines = cylinder.own.lines
        for name, pressure in ((side, 1e6), (other, pilot)):
            key = f'lack_{name}'
            setattr(lines, key, getattr(hosed(pressure=pressure).own.lines, key))
        cylinder.move()
        assert (float(getattr(lines, f'lift_{side}')) > 0.0) is opens


def test_a_flow_through_a_shut_tight_valve_is_none():
    cylinder = hosed(holding_a=COUNTERBALANCE)
    holding = cylinder.plant.holding_a
    holding.k_shut = 0.0
    flow, rate = held_flow(1e6, 8e6, 1e6, 0.0, 1e-4, 1e14, holding, cylinder.plant.hoses)
    assert (flow, rate) == (0.0, 0.0)
