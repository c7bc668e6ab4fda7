"""
Oil below the pressure of the atmosphere and oil with air: its density, and cavities.

At the pressure of the atmosphere the oil is saturated with air; below it released air softens it
(C5), and at its vapour pressure it boils. Entrained air softens it at all pressures (C12). There
the pressure follows from what a chamber holds (C11): an integration of pressures would lose or
make oil where the modulus changes within a step. Pressures are gauge, Pa; ``oil`` is a `CHAMBERS`
record. Neglected: the mass of the vapour, and the time that air needs to leave the oil.
"""

import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.elementary import exp, expm1, log
from isa_ros.core.kernel import kernel

AIR_EXPONENT = 1.4          # 1, kappa of air: it is compressed without exchange of heat
LEAST_AIR_PRESSURE = 1e3    # Pa absolute: oil with air boils there at the latest
_NEAR = 1e-9                # change of an absolute pressure before Newton's last step
_MOST_STEPS = 60            # of Newton's method; some 15 from 1 kPa to 100 MPa


@kernel
def stiffening(p, oil):
    """
    Return the bulk modulus of oil without entrained air, in Pa  (C5).

    beta_eff, below the pressure of the atmosphere beta_eff/(1 - p/p_air), down to the vapour
    pressure.
    """
    if p >= 0.0:
        return oil.beta
    return oil.beta / (1.0 - max(p, oil.p_vapour) / oil.p_air)


@kernel
def strain(p, oil):
    """Return the integral of dp over `stiffening` from 0 to ``p``, 1: p (1 - p/(2 p_air))/beta."""
    if p >= 0.0:
        return p / oil.beta
    return p * (1.0 - 0.5 * p / oil.p_air) / oil.beta


@kernel
def pressure_at(strained, oil):
    """Return the pressure of a `strain`."""
    p = oil.beta * strained
    if p >= 0.0:
        return p
    return 2.0 * p / (1.0 + math.sqrt(1.0 - 2.0 * p / oil.p_air))


@kernel
def shares(p, oil):
    """
    Return the volumes of air and of oil at ``p`` of a volume 1 at that of the atmosphere  (C12).

    a r and (1 - a) exp(-strain), r = (p_0/p)^(1/kappa), p absolute; at no less than
    `LEAST_AIR_PRESSURE`, so that nothing is divided by zero.
    """
    absolute = max(p + ATMOSPHERE, LEAST_AIR_PRESSURE)
    return (oil.air * exp(log(ATMOSPHERE / absolute) / AIR_EXPONENT),
            (1.0 - oil.air) * exp(-strain(p, oil)))


@kernel
def modulus(p, oil):
    """
    Return the bulk modulus at pressure ``p``, in Pa  (C5, C12).

    With entrained air (v_air + v_oil) / (v_air/(kappa p) + v_oil/beta) of the volumes of `shares`,
    p absolute.
    """
    p = max(p, oil.p_vapour)
    beta = stiffening(p, oil)
    if oil.air > 0.0:
        v_air, v_oil = shares(p, oil)
        absolute = max(p + ATMOSPHERE, LEAST_AIR_PRESSURE)
        beta = (v_air + v_oil) / (v_air / (AIR_EXPONENT * absolute) + v_oil / beta)
    return beta


@kernel
def denser(p, oil):
    """Return by which share the oil is denser at ``p`` than at its vapour pressure, 1  (C11)."""
    if oil.air > 0.0:
        v_air, v_oil = shares(oil.p_vapour, oil)
        at_air, at_oil = shares(p, oil)
        return ((v_air - at_air) + (v_oil - at_oil)) / (at_air + at_oil)
    return expm1(strain(p, oil) - strain(oil.p_vapour, oil))


@kernel
def pressure_of(density, near, oil):
    """
    Return the pressure at which oil is ``density`` times as dense as at its vapour pressure.

    With entrained air by Newton's method from a pressure ``near`` it: the volume is a convex
    function of the pressure, so that after its first step it rises to the solution.
    """
    if not oil.air > 0.0:
        return pressure_at(log(density) + strain(oil.p_vapour, oil), oil)
    v_air, v_oil = shares(oil.p_vapour, oil)
    volume = (v_air + v_oil) / density
    p = max(near, oil.p_vapour)
    for _ in range(_MOST_STEPS):
        v_air, v_oil = shares(p, oil)
        own = v_air + v_oil
        last, p = p, max(p + (own - volume) / own * modulus(p, oil), oil.p_vapour)
        if abs(p - last) <= _NEAR * (p + ATMOSPHERE):
            break
    return p


@kernel
def lack(p, cavity, volume, oil):
    """
    Return the volume that the oil of a chamber would leave free at its vapour pressure  (C11).

    In m3: the cavity while there is one, else negative, by the oil that is compressed more.
    """
    return cavity if cavity > 0.0 else -volume * denser(p, oil)


@kernel
def contents(lacking, volume, near, oil):
    """
    Return pressure, elastance (Pa/m3) and `denser` of a chamber that has a `lack`  (C11).

    Oil that boils keeps its pressure: the elastance is 0. ``near`` is a pressure near it, in Pa.
    """
    if lacking >= 0.0:
        return oil.p_vapour, 0.0, 0.0
    more = -lacking / volume
    p = pressure_of(1.0 + more, near, oil)
    return p, modulus(p, oil) / volume, more
