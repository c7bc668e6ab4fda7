"""
Where the power of the oil goes: losses, work and storage of one actuator  (E1 to E6).

Pressures are gauge, so that the energy of a litre is counted from the atmosphere. The balance
closes without a remainder: every term has its own formula, none is the rest of the others.
"""

from isa_ros.core.elementary import exp, log
from isa_ros.core.kernel import kernel
from isa_ros.core.record import rows_of
import numpy as np

_LN_2 = 0.6931471805599453

ENERGIES = np.dtype([
    ('leakage', 'f8'),          # through the lands and the pilot stage of the valve, J  (E2)
    ('throttling', 'f8'),       # at the open lands, J  (E2)
    ('cross_port', 'f8'),       # leakage past the piston or vane, and to the outside, J  (E3)
    ('relief', 'f8'),           # relief and refill valves, J  (E3)
    ('friction', 'f8'),         # seals, J  (E4)
    ('damping', 'f8'),          # damping of the sensor, and end stops, J  (E4)
    ('work', 'f8'),             # done on the load, J  (E5)
    ('compression', 'f8'),      # taken up by the oil in the chambers, J  (E6)
    ('drawn', 'f8'),            # of the oil drawn, where the pressure of the supply moves, J  (E1)
])
"""Powers of one instant, W, or their integrals over time, J."""


def no_powers() -> np.record:
    """Return an `ENERGIES` record of zeros with its fields as attributes."""
    powers: np.record = rows_of(1, ENERGIES)[0]
    return powers


@kernel
def log_cosh(x):
    """Return ln(cosh(x)) without overflow."""
    size = abs(x)
    return size + log(1.0 + exp(-2.0 * size)) - _LN_2


@kernel
def elastic_energy(s, v, x_load, mechanics):
    """
    Return I s'^2/2 + K_s (d^2/2 - j^2 ln cosh(d/j)), d = s - x  (E6), in J.

    The kinetic energy of piston or rotor and that of the spring in the force sensor, the
    integral of M1 over its stretch.
    """
    d, j = s - x_load, mechanics.backlash
    stretch = 0.5 * d * d
    if j > 0.0:
        stretch -= j * j * log_cosh(d / j)
    return 0.5 * mechanics.inertia * v * v + mechanics.k_s * stretch
