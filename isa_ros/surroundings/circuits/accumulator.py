"""
An accumulator: gas behind a bladder or piston, with a temperature of its own.

Its pressure is that of the manifold it stands on. Heat flows through its wall with one time
constant, so that slow changes are isothermal and fast ones adiabatic; there is no polytropic
exponent. Below its precharge it is empty of oil. Gas escapes to the atmosphere at its temperature:
the oil stays, and the pressure falls with the gas. Equation C46.

Neglected: friction and mass of bladder or piston, the neck's resistance (a line between has
one), the heat of the wall itself, and what nitrogen differs from an ideal gas.
"""

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, name, parameter, Parameters
from isa_ros.core.units import LITRE, MPA
import numpy as np

KAPPA = 1.4             # ratio of the heat capacities of nitrogen
ICE = 273.15            # K, 0 celsius

GAS = np.dtype((np.record, [
    ('v_0', 'f8'),          # m3, the accumulator without oil
    ('amount', 'f8'),       # n R, J/K; 0: no gas
    ('theta_a', 'f8'),      # K, around it
    ('tau', 'f8'),          # s, of heat through its wall at constant volume
    ('kappa', 'f8')]))


@frozen(kw_only=True)
class AccumulatorPart(Parameters):
    """A gas accumulator on a manifold."""

    at: str = name('the manifold that it stands on')
    gas_volume_l: float = parameter('gas at precharge, all of it', 'l', gt=0.0, le=500.0)
    precharge_mpa: float = parameter('gauge, at the temperature around it', 'MPa', gt=0.0, le=70.0)
    celsius: float = parameter(
        'temperature around it', 'celsius', absent=20.0, source='assumed', ge=-40.0, le=120.0)
    thermal_time_constant_s: float = parameter(
        'of the heat of the gas through its wall, at constant volume', 's', absent=15.0,
        source='assumed, a few litres', ge=0.05, le=1e4)
    gas_lost: float = fault(
        'share of the gas above the atmosphere that has escaped; it does not come back in a run',
        '1', ge=0.0, le=1.0)


def gas_fields(sheet: AccumulatorPart) -> tuple[float, ...]:
    """Return the fields of the `GAS` of an accumulator."""
    v_0, theta = sheet.gas_volume_l * LITRE, sheet.celsius + ICE
    left = sheet.precharge_mpa * MPA * (1.0 - sheet.gas_lost) + ATMOSPHERE
    amount = left * v_0 / theta
    return v_0, amount, theta, sheet.thermal_time_constant_s, KAPPA


@kernel
def gas_rate(p, theta, inflow, volume, c, gas):
    """
    Return theta', K/s, and the heat that flows into the gas, W  (C46).

    `theta' = (kappa - 1)/kappa theta p'/p + (theta_a - theta)/(kappa tau)`, p absolute, with
    `(C + V/(kappa p)) p' = Q + V (theta_a - theta)/(kappa tau theta)`; p > 0 while there is gas.
    """
    missing = (gas.theta_a - theta) / gas.tau
    heat = gas.amount / (gas.kappa - 1.0) * missing
    if volume >= gas.v_0:
        return missing, heat
    kappa = gas.kappa
    change = (inflow + volume * missing / (kappa * theta)) / (c + volume / (kappa * p))
    return (kappa - 1.0) / kappa * theta * change / p + missing / kappa, heat


@kernel
def gas_energy(volume, theta, gas):
    """Return n R theta/(kappa - 1) less the atmosphere's share, p_a (V_0 - V), J  (E10)."""
    return gas.amount * theta / (gas.kappa - 1.0) - ATMOSPHERE * (gas.v_0 - volume)
