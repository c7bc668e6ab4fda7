"""Manifolds that feed actuators: over four plant steps, and with the coldest oil."""

from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
import pytest
from tests.surroundings.circuits.sheets import MS, sheet_of, SLOPE
from tests.surroundings.circuits.station import STATION
from tests.surroundings.circuits.test_heat import HOT_STATION

BOUND = 80e-6       # s, four plant steps


def test_each_manifold_is_looked_at() -> None:
    """C16: the second one has 0.5 l, the first 0.3 l and the end of a hose."""
    bound = 0.5e-3 / 1.2e9 / BOUND
    Circuit(sheet_of(STATION), MS, [Fed('left', SLOPE), Fed('right', 0.98 * bound)])
    with pytest.raises(ParameterError, match=r'parts\.right: capacity over .* = 0\.0784 ms'):
        Circuit(sheet_of(STATION), MS, [Fed('left', SLOPE), Fed('right', 1.02 * bound)])


@pytest.mark.parametrize('place', ['left', 'right'])
def test_the_actuators_of_each_manifold_bear_the_coldest_oil(place: str) -> None:
    """Its coolant has 12 celsius."""
    def feeding(coldest: float) -> list[Fed]:
        return [Fed(own, SLOPE, coldest=coldest if own == place else -20.0)
                for own in ('left', 'right')]
    Circuit(sheet_of(HOT_STATION), MS, feeding(11.9))
    with pytest.raises(ParameterError, match=(
            r'supply: its oil can get as cold as 12 celsius by its start, air and coolants, must '
            r'be >= 12\.1 celsius')):
        Circuit(sheet_of(HOT_STATION), MS, feeding(12.1))
