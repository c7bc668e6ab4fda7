"""The functions phi_1 and phi_2 of exact steps of linear equations."""

from isa_ros.core.elementary import expm1
from isa_ros.core.kernel import kernel


@kernel
def phi_1(x):
    """Return (e^x - 1)/x, 1 at x = 0."""
    return 1.0 if x == 0.0 else expm1(x) / x


@kernel
def phi_2(x):
    """Return (e^x - 1 - x)/x^2, 1/2 at x = 0; exact where x is so small that it rounds away."""
    return 0.5 if x == 0.0 else (phi_1(x) - 1.0) / x
