"""
How long a point that falls on the ground touches it: the time scale of an impact.

A mass falls on the ground's spring k d^1.5 (Hertz). Neglected: damping, which changes the time by
a few per cent, friction, and weight.
"""

from isa_ros.core.elementary import exp, log

IMPACT_SPEED = 1.0  # m/s, a fall of 5 cm; at four times the speed the time is a quarter shorter
_SHARE, _EXPONENT = 5.0 / 4.0, 2.0 / 5.0    # of the energy, m v^2/2 = (2/5) k d^2.5
HERTZ = 2.943275    # 2 sqrt(pi) Gamma(7/5)/Gamma(9/10), the time in units of depth over speed


def contact_time(mass: float, stiffness: float) -> float:
    """
    Return T = 2.943 d/v, d = (5 m v^2/(4 k))^(2/5), of an impact with `IMPACT_SPEED` v, in s.

    From m d'' = -k d^1.5 with m > 0 in kg and k > 0 in N/m^1.5; d is the greatest depth.
    """
    v = IMPACT_SPEED
    depth = exp(_EXPONENT * log(_SHARE * mass * v * v / stiffness))
    return HERTZ * depth / v
