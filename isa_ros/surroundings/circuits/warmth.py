"""
The temperature of a circuit's oil over a run: what heats it, and what it does to the parts.

The heat of a tick is what the parts have lost, but for what leaks to the outside; what the shafts
of the pumps give beyond the oil; and a share of what the actuators took. Viscosity and
compressibility follow in steps of `STEP` kelvin: what the oil then stores less, by its greater
capacity, is booked as lost. Equations T7 to T9.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.record import row_record
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.errors import ParameterError
from isa_ros.surroundings.circuits.heat import (
    coldest, CoolerPart, heat_capacity, MixedHeat, oil_at, OIL_STATE, warm_oil, ways_of)
from isa_ros.surroundings.circuits.network import OF_PUMP, PER_NODE
from isa_ros.surroundings.circuits.oil import oil_at_sheet, OilNow
from isa_ros.surroundings.circuits.plan import Network, OUTSIDE
from isa_ros.surroundings.circuits.pump import PumpPart
from isa_ros.surroundings.circuits.sheet import CircuitSupply
import numpy as np

STEP = 0.05     # K: viscosity changes by 0.2 %, compressibility by 0.02 %
COLDEST, WARMEST = -60.0, 5000.0    # celsius: no sheet begins so, and no run ends so
_PERCENT = 0.01


class Heating(NamedTuple):
    """Memory of the oil's temperature in a circuit of m elements; no rows where it is constant."""

    oil: np.ndarray
    """`OIL_STATE`, (1,) or (0,)."""
    given: np.ndarray
    """Heat through the walls of the tank and by each cooler since t = 0, J, (k,)."""
    ways: np.ndarray
    """As `ways_of`, (k, 2)."""
    rows: np.ndarray
    """Of the samples of the tank and its coolers, int64, (k,)."""
    numbers: np.ndarray
    """Heat capacity, J/K; share of what the actuators took; `STEP`, K; (3,)."""
    lost: np.ndarray
    """Of its `lost_power`: 1; of a pump 1 - 1/eta, whose lost power is < 0; 0 to the outside."""
    leaked: np.ndarray
    """Of the power of a pump's leakage: 1/eta; 0 of all else, (m,)."""


def no_heat() -> Heating:
    """Return the memory of a circuit whose oil is as warm as it is."""
    none = np.zeros(0)
    return Heating(np.zeros(0, OIL_STATE), none, np.zeros((0, 2)), np.zeros(0, np.int64),
                   np.zeros(3), none, none)


@kernel
def heat_until_now(state, nodes, elements, lost):
    """Return what the losses have heated the oil by, but for the leakage of pumps, J  (T8)."""
    n, m = len(nodes), len(elements)
    total = 0.0
    for j in range(m):
        total += lost[j] * state[PER_NODE * n + m + j]
    for i in range(n):
        if nodes[i].is_held <= 0.0 and nodes[i].gas.amount <= 0.0:
            total -= state[3 * n + i]
    return total


@kernel
def heat_of_leakage(step, state, elements, n, leaked):
    """Return the heat of the leakage of pumps at the mean pressures of a tick, J  (T8)."""
    total = 0.0
    for j in range(len(elements)):
        if leaked[j] > 0.0:
            drop = (state[2 * n + elements[j].inlet] - state[2 * n + elements[j].outlet]) / step
            total += leaked[j] * elements[j].pump.g * drop * drop * step
    return total


@kernel
def warm(step, taken, carried, state, nodes, elements, own):
    """
    Advance the temperature of a `Heating` by a tick of ``step`` s that ends with this state.

    ``taken`` is the energy that the actuators took, J, but for those that have a temperature of
    their own, from which the oil ``carried`` heat (T10). Return whether the oil's properties are
    those of another temperature now.
    """
    if len(own.oil) == 0:
        return False
    oil, numbers = own.oil[0], own.numbers
    until_now = heat_until_now(state, nodes, elements, own.lost)
    heat = (until_now - oil.booked + numbers[1] * taken
            + heat_of_leakage(step, state, elements, len(nodes), own.leaked) + carried)
    oil.booked = until_now
    warm_oil(step, heat, numbers[0], own.ways, oil, own.given)
    if abs(oil.celsius - oil.taken) < numbers[2]:
        return False
    oil.taken = oil.celsius
    return True


@kernel
def show_warmth(own, samples):
    """Write temperature and heat of the whole, the tank and its coolers to their samples."""
    if len(own.oil) == 0:
        return
    oil = own.oil[0]
    samples[0].oil_temperature, samples[0].heat = oil.celsius, oil.got
    for k in range(len(own.rows)):
        sample = samples[own.rows[k]]
        sample.oil_temperature, sample.heat = oil.celsius, own.given[k]


class Warmth:
    """The temperature of the oil of a circuit whose tank has a heat."""

    def __init__(self, sheet: CircuitSupply, heat: MixedHeat) -> None:
        names = sheet.tank, *_coolers(sheet)
        places = list(sheet.by_name)
        n = len(names)
        self.heating = no_heat()._replace(
            oil=np.zeros(1, OIL_STATE), given=np.zeros(n), ways=np.zeros((n, 2)),
            rows=np.array([1 + places.index(name) for name in names], np.int64))
        """Its memory; what `take` changes is changed in place, once it is there."""
        self.oil: np.record = row_record(self.heating.oil)
        """`OIL_STATE`."""
        self.oil.celsius = self.oil.taken = heat.start_celsius

    def take(self, sheet: CircuitSupply, network: Network) -> None:
        """Continue with values of a sheet, at the temperature that the oil has."""
        assert isinstance(sheet.heat, MixedHeat)
        n = len(network.elements)
        if len(self.heating.lost) < n:
            self.heating = self.heating._replace(lost=np.zeros(n), leaked=np.zeros(n))
        own = self.heating
        own.ways[:] = ways_of(sheet.heat, list(_coolers(sheet).values()))
        own.numbers[:] = (
            heat_capacity(sheet.heat), _PERCENT * sheet.heat.actuators_percent, STEP)
        own.lost[:], own.leaked[:] = _shares(sheet, network)

    def oil_now(self, sheet: CircuitSupply) -> OilNow:
        """Return the oil at the temperature that viscosity and compressibility have."""
        assert isinstance(sheet.heat, MixedHeat)
        return oil_at(sheet.oil, sheet.heat, float(self.oil.taken))

    def refuse_cold(self, sheet: CircuitSupply, least: float, name: str) -> None:
        """
        Refuse oil that can get colder than its actuators' steps can follow, ``least`` celsius.

        Raises
        ------
        ParameterError
            With both temperatures.

        """
        celsius = _coldest_celsius(sheet, self)
        if celsius < least:
            raise ParameterError(
                f'{name}: its oil can get as cold as {celsius:g} celsius by its start, air and '
                f'coolants, must be >= {least:.3g} celsius: the friction of an actuator that it '
                f'feeds is too fast for the plant step of {PLANT_STEP_NS / 1e3:g} us')

    def snapshot(self) -> bytes:
        """Return its state."""
        return self.oil.tobytes() + self.heating.given.tobytes()

    def can_be(self, numbers: np.ndarray) -> bool:
        """Return whether numbers are those of a `snapshot`: both temperatures of oil."""
        return bool((COLDEST <= numbers[:2]).all() and (numbers[:2] <= WARMEST).all())

    def restore(self, numbers: np.ndarray) -> None:
        """Continue from the numbers of a `snapshot`."""
        for name, value in zip(OIL_STATE.names or (), numbers):
            self.oil[name] = value
        self.heating.given[:] = numbers[len(OIL_STATE.names or ()):]


def warmth_of(sheet: CircuitSupply) -> Warmth | None:
    """Return the temperature of a circuit's oil, or None: it stays as it is."""
    heat = sheet.heat
    return Warmth(sheet, heat) if isinstance(heat, MixedHeat) else None


def coldest_oil(sheet: CircuitSupply, own: Warmth | None) -> OilNow:
    """Return the oil of a circuit at the least temperature that it has or can get."""
    heat = sheet.heat
    if own is None or not isinstance(heat, MixedHeat):
        return oil_at_sheet(sheet.oil)
    return oil_at(sheet.oil, heat, _coldest_celsius(sheet, own))


def _coldest_celsius(sheet: CircuitSupply, own: Warmth) -> float:
    """Return the least temperature that the oil has or can get by a sheet."""
    assert isinstance(sheet.heat, MixedHeat)
    ways = ways_of(sheet.heat, list(_coolers(sheet).values()))
    return min(coldest(sheet.heat, ways), float(own.oil.celsius))


def _coolers(sheet: CircuitSupply) -> dict[str, CoolerPart]:
    return {name: part for name, part in sheet.by_name.items() if isinstance(part, CoolerPart)}


def _shares(sheet: CircuitSupply, network: Network) -> tuple[np.ndarray, np.ndarray]:
    """Return what of the losses of each element heats the oil, as in a `Heating`  (T8)."""
    lost = np.array([float(element['outlet'] != OUTSIDE) for element in network.elements])
    leaked = np.zeros(len(lost))
    for j, (owner, element) in enumerate(zip(network.owners, network.elements)):
        if element['law'] == OF_PUMP:
            part = sheet.by_name[owner]
            assert isinstance(part, PumpPart)
            leaked[j] = 1.0 / (_PERCENT * part.efficiency_percent)
            lost[j] = 1.0 - leaked[j]
    return lost, leaked
