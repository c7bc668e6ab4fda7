"""
A check valve: the flow opens it, and its seat shuts it. Equation C51.

Flow > 0 runs from the inlet to the outlet. Neglected: the mass of its poppet, and the little
oil that flows back while it shuts.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.parameter import fault, name, parameter, Parameters
from isa_ros.core.units import LPM, MPA
from isa_ros.surroundings.circuits.orifice import rated, SMOOTH, through
import numpy as np

CHECK = np.dtype((np.record, [
    ('k', 'f8'),            # open, m3/s/sqrt(Pa)
    ('g', 'f8'),            # past the seat, m3/s/Pa
    ('p_open', 'f8'),       # Pa
    ('is_open', 'f8')]))    # 1: stuck open


@frozen(kw_only=True)
class CheckPart(Parameters):
    """A check valve: oil flows from its inlet to its outlet only."""

    inlet: str = name('a manifold or the tank')
    outlet: str = name('a manifold or the tank')
    rated_lpm: float = parameter(
        'flow at the rated drop, beyond the opening pressure', 'l/min', gt=0.0, le=10000.0)
    rated_drop_mpa: float = rated()
    opens_mpa: float = parameter(
        'drop at which it begins to open', 'MPa', absent=0.05, source='assumed', ge=0.0, le=10.0)
    stuck_shut: float = fault('1: it does not open', '1', is_whole=True, ge=0.0, le=1.0)
    stuck_open: float = fault('1: it does not shut', '1', is_whole=True, ge=0.0, le=1.0)
    spring_broken: float = fault(
        '1: it opens at no pressure', '1', is_whole=True, ge=0.0, le=1.0)
    leakage_lpm_per_mpa: float = fault(
        'flow past its seat per pressure', 'l/min/MPa', ge=0.0, le=100.0)


def check_fields(sheet: CheckPart) -> tuple[float, ...]:
    """Return the fields of the `CHECK` of a check valve."""
    return (through(sheet.rated_lpm, sheet.rated_drop_mpa) * (1.0 - sheet.stuck_shut),
            sheet.leakage_lpm_per_mpa * LPM / MPA,
            sheet.opens_mpa * MPA * (1.0 - sheet.spring_broken), sheet.stuck_open)


@kernel
def check_flow(drop, check):
    """Return `K S(max(0, dP - P_open)) + g dP`, m3/s; stuck open `K S(dP)`  (C51)."""
    beyond = drop if check.is_open > 0.0 else max(0.0, drop - check.p_open)
    return check.k * signed_sqrt(beyond, SMOOTH) + check.g * drop
