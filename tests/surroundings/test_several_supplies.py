"""Several supplies at once: each by itself, called one by one as in a compiled loop."""

from collections.abc import Sequence

from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, START, SUPPLY_PORT, SUPPLY_REPLY
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.feeding import SupplyCircuit
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np
import pytest
from tests.surroundings.circuits.sheets import sheet_of
from tests.surroundings.circuits.test_heat import HOT
from tests.surroundings.supplied import SHEET, SLOPE
from tests.surroundings.test_supply_port import MOVING, MS

LITTLE = HOT.replace('oil_volume_l: 0.5, metal_heat_capacity: 120.0',
                     'oil_volume_l: 0.05, metal_heat_capacity: 0.0')
"""A circuit whose oil gets other properties every few ticks."""


def surroundings(*circuits: SupplyCircuit) -> Surroundings:
    """Return surroundings of an actuator for each circuit."""
    n = len(circuits)
    return Surroundings(circuits, {}, np.zeros(n, START), [1e9] * n, MS)


def hot(name: str, row: int, text: str = LITTLE) -> SupplyCircuit:
    return SupplyCircuit(name, sheet_of(text), [row], SLOPE, [Fed('main', SLOPE, rows=(row,))])


def replies_of(drawn: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return replies of actuators that draw these volumes, and what they paid, 20 MJ/m3."""
    replies, fed = np.zeros(len(drawn), LOAD_REPLY), np.zeros(len(drawn), SUPPLY_REPLY)
    replies['supply_volume'], fed['paid'] = drawn, 20e6 * np.array(drawn)
    return replies, fed


def by_parts(own: Surroundings, replies: np.ndarray, fed: np.ndarray, ticks: int) -> int:
    """Advance by ticks as the compiled loop does; return how many of them a part has ended."""
    n, ended = len(replies), 0
    parts = own.parts(np.zeros(n, LOAD_PORT), np.zeros(n, SUPPLY_PORT), replies, fed)
    assert parts is not None
    for _ in range(ticks):
        for part in (*parts[0], *parts[1]):
            found = part.bound.run()
            if found:
                part.found(found)
                ended += 1
                break
    return ended


def test_a_supply_that_holds_its_pressure_is_paid_it_beside_one_that_moves() -> None:
    """E9: 20.7 MPa over the volume, whatever else its actuator has counted."""
    one, other = (surroundings(
        SupplyCircuit('held', SHEET, [0], SLOPE), SupplyCircuit('moving', MOVING, [1], SLOPE))
        for _ in range(2))
    replies, fed = replies_of([1e-6, 2e-6])
    one.advance(replies, fed)
    assert one.supplies['energy'] == pytest.approx([20.7, 40.0], rel=1e-12)
    feeds: np.ndarray = np.zeros(2, SUPPLY_PORT)
    one.fill_feeds(feeds)
    assert feeds['elastance'][0] == 0.0 < feeds['elastance'][1]
    assert by_parts(other, replies, fed, 1) == 0
    assert other.supplies.tobytes() == one.supplies.tobytes()


@pytest.mark.parametrize('first', [LITTLE, HOT])
def test_each_of_two_warm_circuits_is_as_it_is_alone(first: str) -> None:
    """Both get oil of other properties, in ticks of their own, which end a call."""
    replies, fed = replies_of([3e-8, 1e-8])
    both, alone, looped = (surroundings(*own) for own in (
        (hot('one', 0, first), hot('two', 1)), (hot('two', 0),),
        (hot('one', 0, first), hot('two', 1))))
    for _ in range(40):
        both.advance(replies, fed)
        alone.advance(replies[1:], fed[1:])
    n = len(alone.supplies)
    assert both.supplies[-n:].tobytes() == alone.supplies.tobytes()
    temperatures = [float(both.supplies[place]['oil_temperature']) for place in (0, -n)]
    assert temperatures[1] > 31.2 and temperatures[0] != temperatures[1]
    assert 5 < by_parts(looped, replies, fed, 40) < 40
    assert looped.snapshot() == both.snapshot()
    assert looped.supplies.tobytes() == both.supplies.tobytes()
