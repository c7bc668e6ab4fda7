"""
A node of a circuit: one pressure for all the oil in it.

Its state is its content, the oil that has entered it since it stood at atmospheric pressure, so
that oil is neither made nor lost whatever the pressures do; the pressure follows from it:
`D = C P + V_0 - V_g` with `C = V/beta` and the gas of an accumulator (C46), if there is one.
Oil that is missing leaves a cavity at the vapour's pressure, as in C11. Pressures are gauge.
Equation C45.
"""

import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.kernel import kernel
from isa_ros.surroundings.circuits.accumulator import GAS, gas_energy, gas_rate
import numpy as np

VAPOUR = -1.0e5     # Pa gauge, of boiling oil
_NEWTON_STEPS = 4   # from an error of 1e-4 to rounding

NODE = np.dtype((np.record, [
    ('is_held', 'f8'),      # 1: of a tank, or outside, at the pressure p_held
    ('p_held', 'f8'),       # Pa
    ('c', 'f8'),            # V/beta of all the oil at it, m3/Pa
    ('gas', GAS)]))


@kernel
def is_without_oil(content, theta, node):
    """Return whether the gas of a node, if it has any, fills its shell  (C46)."""
    gas = node.gas
    return gas.amount <= 0.0 or (content / node.c + ATMOSPHERE) * gas.v_0 <= gas.amount * theta


@kernel
def phase_of(content, theta, node):
    """Return 0 with oil in its accumulator, 1 without, 2 with a cavity: P has corners between."""
    if not is_without_oil(content, theta, node):
        return 0
    return 1 if content > node.c * VAPOUR else 2


@kernel
def node_pressure(content, theta, node):
    """
    Return the pressure of a node, in Pa  (C45).

    With gas `C p^2 + (V_0 - C p_a - D) p - n R theta = 0`, p absolute; c > 0 by the ranges of
    volume and bulk modulus.
    """
    if node.is_held > 0.0:
        return node.p_held
    if is_without_oil(content, theta, node):
        return max(VAPOUR, content / node.c)
    gas = node.gas
    b = content + node.c * ATMOSPHERE - gas.v_0
    root = math.sqrt(b * b + 4.0 * node.c * gas.amount * theta)
    if b < 0.0:
        return 2.0 * gas.amount * theta / (root - b) - ATMOSPHERE
    return 0.5 * (b + root) / node.c - ATMOSPHERE


@kernel
def gas_volume(pressure, theta, node):
    """Return the volume of the gas at a node, m3; 0 without gas."""
    gas = node.gas
    if gas.amount <= 0.0:
        return 0.0
    return min(gas.v_0, gas.amount * theta / max(pressure + ATMOSPHERE, 1.0))


@kernel
def node_content(pressure, theta, node):
    """Return the content at a pressure above the vapour's, m3: the inverse of `node_pressure`."""
    if node.gas.amount <= 0.0:
        return node.c * pressure
    return node.c * pressure + (node.gas.v_0 - gas_volume(pressure, theta, node))


@kernel
def node_capacity(pressure, theta, node):
    """Return dD/dP at once, m3/Pa: C, and V_g/(kappa p) of a gas that has no time for heat."""
    capacity = node.c
    if node.gas.amount > 0.0:
        volume = gas_volume(pressure, theta, node)
        if volume < node.gas.v_0:
            capacity += volume / (node.gas.kappa * (pressure + ATMOSPHERE))
    return capacity


@kernel
def feeding_capacity(pressure, theta, node):
    """Return `node_capacity`, m3/Pa; without end of a cavity, whose pressure does not change."""
    if pressure <= VAPOUR:
        return math.inf
    return node_capacity(pressure, theta, node)


@kernel
def node_energy(content, theta, node):
    """
    Return what is stored in a node, more than at atmospheric pressure without gas, J  (E10).

    A tank stores nothing: what it takes is gone with its pressure (E12).
    """
    if node.is_held > 0.0:
        return 0.0
    pressure = node_pressure(content, theta, node)
    stored = 0.5 * node.c * pressure * pressure + min(0.0, content - node.c * VAPOUR) * VAPOUR
    if node.gas.amount > 0.0:
        stored += gas_energy(gas_volume(pressure, theta, node), theta, node.gas)
    return stored


@kernel
def temperature_with(energy, content, theta, node):
    """
    Return the temperature of its gas at which a node stores ``energy``, in K  (E10).

    Newton's method from ``theta``, which is near: of the content D `dE/dtheta = n R/(kappa - 1)`,
    and with oil in the accumulator `C p n R/(V_g + C p)` more. There is gas.
    """
    gas = node.gas
    for _ in range(_NEWTON_STEPS):
        slope = gas.amount / (gas.kappa - 1.0)
        if not is_without_oil(content, theta, node):
            pressure = node_pressure(content, theta, node)
            soft = node.c * (pressure + ATMOSPHERE)
            slope += soft * gas.amount / (gas_volume(pressure, theta, node) + soft)
        theta -= (node_energy(content, theta, node) - energy) / slope
    return theta


@kernel
def heat_rates(pressure, theta, inflow, node):
    """Return (theta', power that the gas gets of what surrounds it) with ``inflow``  (C46)."""
    gas = node.gas
    if gas.amount <= 0.0:
        return 0.0, 0.0
    return gas_rate(pressure + ATMOSPHERE, theta, inflow,
                    gas_volume(pressure, theta, node), node.c, gas)
