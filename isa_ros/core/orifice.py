"""The square root of an orifice, regularised at no pressure drop, and its slope."""

import math

from isa_ros.core.kernel import kernel


@kernel
def signed_sqrt(dp, delta):
    """
    Return dp / (dp^2 + delta^2)^(1/4)  (V5), in sqrt(Pa).

    Regularised sgn(dp) sqrt(|dp|) with the finite slope 1/sqrt(delta) at dp = 0; 0.25 % low
    at ten times delta.
    """
    return dp / math.sqrt(math.sqrt(dp * dp + delta * delta))


@kernel
def root_slope(dp, delta):
    """Return dS/d(dP) of V5, in 1/sqrt(Pa)."""
    squares = dp * dp + delta * delta
    return (0.5 * dp * dp + delta * delta) / (squares * math.sqrt(math.sqrt(squares)))
