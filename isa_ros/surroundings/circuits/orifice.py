"""
Valves with an opening that is sent somewhere: block valve, dump valve, unloading valve.

Flow > 0 runs from the inlet to the outlet. The opening moves with one lag. The emergency stop
takes the current of all switched valves: a dump valve opens, a block valve shuts. Equation C52.

Neglected: forces of the flow on the poppet, and its mass.
"""

import math
from typing import Any

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.parameter import fault, name, parameter, Parameters
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.errors import ParameterError
import numpy as np

SMOOTH = 2e4            # Pa, delta of V5: small against the drop over a valve at its rated flow

ORIFICE = np.dtype((np.record, [
    ('k', 'f8'),            # of the open valve, m3/s/sqrt(Pa)
    ('delta', 'f8'),        # Pa, of V5
    ('g', 'f8'),            # past the seat, m3/s/Pa
    ('lag', 'f8'),          # s, of the opening; 0: it does not move
    ('target', 'f8'),       # opening that it goes to, where it is switched
    ('p_on', 'f8'),         # Pa, at which an unloading valve opens; 0: it is switched
    ('p_off', 'f8')]))      # and shuts


def rated() -> Any:
    """Declare the drop of a rated flow."""
    return parameter('pressure drop at the rated flow', 'MPa', absent=0.5, source='assumed',
                     gt=0.0, le=10.0)


def _lag() -> Any:
    return parameter(
        'of its opening', 'ms', absent=20.0, source='assumed', ge=1.0, le=10e3)


def _stuck() -> Any:
    return fault('1: its opening stays as it is', '1', is_whole=True, ge=0.0, le=1.0)


def _leaking() -> Any:
    return fault('flow past its seat per pressure', 'l/min/MPa', ge=0.0, le=100.0)


@frozen(kw_only=True)
class SwitchedPart(Parameters):
    """A valve whose current the emergency stop takes."""

    inlet: str = name('a manifold')
    outlet: str = name('a manifold or the tank')
    rated_lpm: float = parameter('flow at the rated drop', 'l/min', gt=0.0, le=10000.0)
    rated_drop_mpa: float = rated()
    time_constant_ms: float = _lag()
    stuck: float = _stuck()
    leakage_lpm_per_mpa: float = _leaking()


@frozen(kw_only=True)
class BlockPart(SwitchedPart):
    """A valve that is open with current, and shuts at the emergency stop."""

    outlet: str = name('a manifold')


@frozen(kw_only=True)
class DumpPart(SwitchedPart):
    """A valve that is shut with current, and opens at the emergency stop."""


@frozen(kw_only=True)
class UnloadingPart(Parameters):
    """A valve that lets a pump's flow to the tank while an accumulator is full."""

    inlet: str = name('the manifold that is unloaded')
    outlet: str = name('a manifold or the tank')
    senses: str = name('the manifold whose pressure switches it, behind a check valve')
    opens_mpa: float = parameter(
        'gauge pressure at which it opens', 'MPa', changeable=True, gt=0.0, le=70.0)
    shuts_mpa: float = parameter(
        'gauge pressure at which it shuts, below that', 'MPa', changeable=True, gt=0.0, le=70.0)
    rated_lpm: float = parameter('flow at the rated drop', 'l/min', gt=0.0, le=10000.0)
    rated_drop_mpa: float = rated()
    time_constant_ms: float = _lag()
    stuck: float = _stuck()
    leakage_lpm_per_mpa: float = _leaking()

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.shuts_mpa >= self.opens_mpa:
            raise ParameterError(
                f'shuts_mpa = {self.shuts_mpa:g} MPa, must be < opens_mpa = {self.opens_mpa:g} '
                'MPa: between them it stays as it is')


def through(lpm: float, drop_mpa: float) -> float:
    """Return K of an orifice with this flow at this drop, m3/s/sqrt(Pa)."""
    return lpm * LPM / math.sqrt(drop_mpa * MPA)


def orifice_fields(sheet: SwitchedPart | UnloadingPart, has_current: bool) -> tuple[float, ...]:
    """Return the fields of the `ORIFICE` of a valve."""
    p_on, p_off = (sheet.opens_mpa * MPA, sheet.shuts_mpa * MPA) if isinstance(
        sheet, UnloadingPart) else (0.0, 0.0)
    return (through(sheet.rated_lpm, sheet.rated_drop_mpa), SMOOTH,
            sheet.leakage_lpm_per_mpa * LPM / MPA,
            0.0 if sheet.stuck else sheet.time_constant_ms * MILLI,
            float(has_current == isinstance(sheet, BlockPart)), p_on, p_off)


@kernel
def orifice_flow(drop, opening, orifice):
    """Return `z K S(dP) + g dP`, m3/s  (C52)."""
    return opening * orifice.k * signed_sqrt(drop, orifice.delta) + orifice.g * drop


@kernel
def opening_rate(opening, latch, orifice):
    """Return z' = (target - z)/T, 1/s; of an unloading valve the target is its ``latch``."""
    if orifice.lag <= 0.0:
        return 0.0
    target = latch if orifice.p_on > 0.0 else orifice.target
    return (target - opening) / orifice.lag


@kernel
def latched(latch, pressure, orifice):
    """Return whether an unloading valve is to be open: 1 from P_on on, until P_off."""
    if orifice.p_on <= 0.0:
        return latch
    if pressure >= orifice.p_on:
        return 1.0
    return 0.0 if pressure <= orifice.p_off else latch
