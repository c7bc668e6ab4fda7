"""
Heat of a circuit: one temperature of all its oil, which losses raise, and air and coolers lower.

What parts, pumps and actuators lose heats the oil; the tank's walls and the coolers take it to
the air (T7, T8). Over a tick the losses have their mean, so that the step is exact however long
it is. Neglected: that oil which returns is warmer than the tank's, by at most P_S/(rho c), 12 K
at 20.7 MPa; the heat of the gas in accumulators; the heat of coils.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.oil_properties import MineralOil, properties_record, softness, thickness
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.phi import phi_1, phi_2
from isa_ros.core.units import LITRE
from isa_ros.surroundings.circuits.oil import CircuitOil, oil_at_sheet, OilNow
import numpy as np


@frozen(kw_only=True)
class NoneHeat(Parameters):
    """Oil as the section `oil` has it, whatever the losses."""


@frozen(kw_only=True)
class MixedHeat(Parameters):
    """The oil of tank and circuit as one heat capacity, well mixed."""

    oil_volume_l: float = parameter('of tank and circuit', 'l', gt=0.0, le=1e5)
    metal_heat_capacity: float = parameter(
        'of tank, blocks and pipes, as warm as the oil', 'J/K', absent=0.0,
        source='assumed, of the oil alone', ge=0.0, le=1e8)
    start_celsius: float = parameter(
        'of the oil at t = 0', 'celsius', absent=40.0, source='assumed', ge=-30.0, le=80.0)
    sheet_celsius: float = parameter(
        'at which the values of the section oil hold, and leakages of pumps', 'celsius',
        absent=40.0, source='assumed', ge=-30.0, le=80.0)
    air_celsius: float = parameter(
        'of the air around the tank', 'celsius', absent=25.0, source='assumed', changeable=True,
        ge=-30.0, le=80.0)
    walls_w_per_k: float = parameter(
        'heat through the walls of the tank', 'W/K', absent=0.0, source='assumed, none',
        ge=0.0, le=1e5)
    actuators_percent: float = parameter(
        'of the energy that the actuators take, which heats the oil', '%', absent=100.0,
        source='assumed, no work over a cycle', ge=0.0, le=100.0)
    oil: MineralOil


TankHeat = NoneHeat | MixedHeat


@frozen(kw_only=True)
class CoolerPart(Parameters):
    """A cooler of the tank's oil, with a loop and a fan of its own."""

    w_per_k: float = parameter(
        'heat per kelvin between oil and air or water', 'W/K', changeable=True, ge=0.0, le=1e6)
    coolant_celsius: float = parameter(
        'of the air or water at its inlet', 'celsius', absent=25.0, source='assumed',
        changeable=True, ge=-30.0, le=80.0)
    fouled: float = fault('share of its heat that dirt keeps back', '1', ge=0.0, le=1.0)


OIL_STATE = np.dtype((np.record, [
    ('celsius', 'f8'),
    ('taken', 'f8'),        # celsius that viscosity and compressibility have
    ('booked', 'f8'),       # J of losses that the oil has got, by the circuit's state
    ('got', 'f8')]))        # J of all losses since t = 0
"""Temperature of a circuit's oil; beside it the heat given through walls and coolers, (n,), J."""


def heat_capacity(sheet: MixedHeat) -> float:
    """Return rho c V + C_m, in J/K."""
    return (sheet.oil.density * sheet.oil.specific_heat * sheet.oil_volume_l * LITRE
            + sheet.metal_heat_capacity)


def ways_of(sheet: MixedHeat, coolers: list[CoolerPart]) -> np.ndarray:
    """Return conductance (W/K) and temperature (celsius) of the walls and each cooler, (n, 2)."""
    return np.array([
        (sheet.walls_w_per_k, sheet.air_celsius),
        *((own.w_per_k * (1.0 - own.fouled), own.coolant_celsius) for own in coolers)])


def coldest(sheet: MixedHeat, ways: np.ndarray) -> float:
    """Return the least temperature that the oil can have: losses only add to it, celsius."""
    return min((sheet.start_celsius, *(
        float(celsius) for conductance, celsius in ways if conductance > 0.0)))


def oil_at(oil: CircuitOil, sheet: MixedHeat, celsius: float) -> OilNow:
    """Return the oil at a temperature: nu by T1, beta by T2, of the section's at its own  (T9)."""
    own = properties_record(sheet.oil, sheet.sheet_celsius)
    return oil_at_sheet(oil, float(thickness(celsius, own)), float(softness(celsius, own)))


@kernel
def warm_oil(h, heat, capacity, ways, oil, given):
    """
    Advance the temperature of an `OIL_STATE` by ``h`` s in which it gets ``heat``, J  (T7).

    ``capacity`` in J/K, ``ways`` (n, 2) as `ways_of`, ``given`` (n,) what went through them, J.
    The temperature is theta + h phi_1(z) f and its mean theta + h phi_2(z) f with the rate f at
    the start and z = -h G/C.
    """
    total, flow = 0.0, heat / h
    for k in range(len(ways)):
        total += ways[k, 0]
        flow += ways[k, 0] * (ways[k, 1] - oil.celsius)
    z, rise = -h * total / capacity, h * flow / capacity
    mean = oil.celsius + phi_2(z) * rise
    oil.celsius += phi_1(z) * rise
    oil.got += heat
    for k in range(len(ways)):
        given[k] += h * ways[k, 0] * (mean - ways[k, 1])
