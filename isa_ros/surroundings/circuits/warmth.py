"""
The temperature of a circuit's oil over a run: what heats it, and what it does to the parts.

The heat of a tick is what the parts have lost, but for what leaks to the outside; what the shafts
of the pumps give beyond the oil; and a share of what the actuators took. Viscosity and
compressibility follow in steps of `STEP` kelvin: what the oil then stores less, by its greater
capacity, is booked as lost. Equations T7 to T9.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
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


class Shares(NamedTuple):
    """What of the losses of each element heats the oil, (m,) each."""

    lost: np.ndarray
    """Of its `lost_power`: 1; of a pump 1 - 1/eta, whose lost power is < 0; 0 to the outside."""
    leaked: np.ndarray
    """Of the power of a pump's leakage: 1/eta; 0 of all else."""


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


class Warmth:
    """
    The temperature of the oil of a circuit whose tank has a heat.

    ``names`` are the tank and its coolers, in the order of ``given``.
    """

    def __init__(self, sheet: CircuitSupply, heat: MixedHeat) -> None:
        self.oil: np.record = np.zeros(1, OIL_STATE).view(np.recarray)[0]
        """`OIL_STATE`."""
        self.oil.celsius = self.oil.taken = heat.start_celsius
        self.names = (sheet.tank, *_coolers(sheet))
        self.given = np.zeros(len(self.names))
        """Heat through the walls of the tank and by each cooler since t = 0, J."""
        self._heat, self._ways = heat, np.zeros((0, 2))
        self._shares = Shares(np.zeros(0), np.zeros(0))

    def take(self, sheet: CircuitSupply, network: Network) -> None:
        """Continue with values of a sheet, at the temperature that the oil has."""
        assert isinstance(sheet.heat, MixedHeat)
        self._heat, self._ways = sheet.heat, ways_of(sheet.heat, list(_coolers(sheet).values()))
        self._shares = _shares(sheet, network)

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

    def advance(
            self, step: float, taken: float, carried: float, state: np.ndarray,
            network: Network) -> bool:
        """
        Advance by a tick of ``step`` s after which the circuit has this state.

        ``taken`` is the energy that the actuators took, J, but for those that have a temperature
        of their own, from which the oil ``carried`` heat (T10). Return whether the oil's
        properties are those of another temperature now.
        """
        nodes, elements = network.nodes, network.elements
        until_now = heat_until_now(state, nodes, elements, self._shares.lost)
        heat = (until_now - self.oil.booked + _PERCENT * self._heat.actuators_percent * taken
                + heat_of_leakage(step, state, elements, len(nodes), self._shares.leaked)
                + carried)
        self.oil.booked = until_now
        warm_oil(step, heat, heat_capacity(self._heat), self._ways, self.oil, self.given)
        if abs(self.oil.celsius - self.oil.taken) < STEP:
            return False
        self.oil.taken = self.oil.celsius
        return True

    def show(self, rows: dict[str, int], samples: np.ndarray) -> None:
        """Write temperature and heat of the whole, the tank and its coolers to their rows."""
        samples[0]['oil_temperature'], samples[0]['heat'] = self.oil.celsius, self.oil.got
        for name, given in zip(self.names, self.given):
            samples[rows[name]]['oil_temperature'] = self.oil.celsius
            samples[rows[name]]['heat'] = given

    def snapshot(self) -> bytes:
        """Return its state."""
        return self.oil.tobytes() + self.given.tobytes()

    def can_be(self, numbers: np.ndarray) -> bool:
        """Return whether numbers are those of a `snapshot`: both temperatures of oil."""
        return bool((COLDEST <= numbers[:2]).all() and (numbers[:2] <= WARMEST).all())

    def restore(self, numbers: np.ndarray) -> None:
        """Continue from the numbers of a `snapshot`."""
        for name, value in zip(OIL_STATE.names or (), numbers):
            self.oil[name] = value
        self.given[:] = numbers[len(OIL_STATE.names or ()):]


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


def _shares(sheet: CircuitSupply, network: Network) -> Shares:
    """Return what of the losses of each element heats the oil  (T8)."""
    lost = np.array([float(element['outlet'] != OUTSIDE) for element in network.elements])
    leaked = np.zeros(len(lost))
    for j, (owner, element) in enumerate(zip(network.owners, network.elements)):
        if element['law'] == OF_PUMP:
            part = sheet.by_name[owner]
            assert isinstance(part, PumpPart)
            leaked[j] = 1.0 / (_PERCENT * part.efficiency_percent)
            lost[j] = 1.0 - leaked[j]
    return Shares(lost, leaked)
