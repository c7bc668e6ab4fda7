"""
A relief valve, and what lets oil through in proportion to its pressure drop.

Flow > 0 runs from the inlet to the outlet. Equation C50.

Neglected: its dynamics; a piloted valve's lag is that of the lines around it.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, name, parameter, Parameters
from isa_ros.core.units import LPM, MPA
import numpy as np

RELIEF = np.dtype((np.record, [
    ('g', 'f8'),            # of what is always open, m3/s/Pa
    ('k', 'f8'),            # above its opening pressure, m3/s/Pa
    ('p_open', 'f8')]))     # Pa


@frozen(kw_only=True)
class ReliefPart(Parameters):
    """A relief valve, which a spring holds shut."""

    inlet: str = name('the manifold that it protects')
    outlet: str = name('a manifold or the tank')
    opens_mpa: float = parameter(
        'above its outlet, at which it begins to open', 'MPa', changeable=True, gt=0.0, le=80.0)
    lpm_per_mpa: float = parameter(
        'flow per pressure above that', 'l/min/MPa', gt=0.0, le=1e4)
    stuck_shut: float = fault('1: it does not open', '1', is_whole=True, ge=0.0, le=1.0)
    spring_broken: float = fault(
        '1: nothing holds it shut', '1', is_whole=True, ge=0.0, le=1.0)
    leakage_lpm_per_mpa: float = fault(
        'flow past its seat per pressure', 'l/min/MPa', ge=0.0, le=100.0)


@frozen(kw_only=True)
class FilterPart(Parameters):
    """A filter with a bypass, also one that gives a return line its back pressure."""

    inlet: str = name('a manifold')
    outlet: str = name('a manifold or the tank')
    lpm_per_mpa: float = parameter(
        'flow through the clean element per pressure', 'l/min/MPa', gt=0.0, le=1e5)
    bypass_opens_mpa: float = parameter(
        'drop at which its bypass begins to open', 'MPa', absent=0.35, source='assumed',
        gt=0.0, le=40.0)
    bypass_lpm_per_mpa: float = parameter(
        'flow through the bypass per pressure above that', 'l/min/MPa', absent=200.0,
        source='assumed', gt=0.0, le=1e5)
    clogged: float = fault('share of the element that dirt has shut', '1', ge=0.0, le=1.0)


def relief_fields(sheet: ReliefPart) -> tuple[float, float, float]:
    """Return the fields of the `RELIEF` of a relief valve."""
    return (sheet.leakage_lpm_per_mpa * LPM / MPA,
            sheet.lpm_per_mpa * LPM / MPA * (1.0 - sheet.stuck_shut),
            sheet.opens_mpa * MPA * (1.0 - sheet.spring_broken))


def filter_fields(sheet: FilterPart) -> tuple[float, float, float]:
    """Return the fields of the `RELIEF` of a filter: its element and its bypass."""
    return (sheet.lpm_per_mpa * LPM / MPA * (1.0 - sheet.clogged),
            sheet.bypass_lpm_per_mpa * LPM / MPA, sheet.bypass_opens_mpa * MPA)


@kernel
def relief_flow(drop, relief):
    """Return `g dP + k max(0, dP - P_open)`, m3/s  (C50)."""
    return relief.g * drop + relief.k * max(0.0, drop - relief.p_open)
