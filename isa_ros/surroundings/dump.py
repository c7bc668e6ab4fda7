"""
The dump valve of a supply: without current it opens, and lets the oil of the line into the tank.

An accumulator keeps its pressure, and drives what is left open, long after its pump has stopped.
The emergency stop opens the valve and switches the pump off; `dump.opened` is the line that does
both, 1 while it is open. The oil goes to the tank by a line of its own, past the return line.
"""

import math
from typing import Any

from isa_ros.core.elementary import exp
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.units import LPM, MPA
from isa_ros.surroundings.return_line import SUPPLY_STEP
import numpy as np


def _opened() -> Any:
    return fault('1: the dump valve has no current, and the pump none', '1', is_whole=True,
                 ge=0.0, le=1.0)


@frozen(kw_only=True)
class NoneDump(Parameters):
    """The supply has no dump valve."""


@frozen(kw_only=True)
class LagDump(Parameters):
    """The pressure of an ideal supply falls to that of its return with one lag."""

    time_constant_ms: float = parameter(
        'of the pressure', 'ms', absent=50.0, source='assumed', ge=1.0, le=60e3)
    opened: float = _opened()


@frozen(kw_only=True)
class ValveDump(Parameters):
    """A valve from the pressure line to the tank, whose opening follows its line with one lag."""

    rated_lpm: float = parameter(
        'flow of the open valve at the rated drop', 'l/min', absent=60.0, source='assumed',
        gt=0.0, le=1000.0)
    rated_drop_mpa: float = parameter(
        'pressure drop at the rated flow', 'MPa', absent=0.7, source='assumed', gt=0.0, le=10.0)
    time_constant_ms: float = parameter(
        'of the opening', 'ms', absent=20.0, source='assumed', ge=1.0, le=10e3)
    opened: float = _opened()


DUMP = np.dtype([
    ('is_there', 'f8'),
    ('is_open', 'f8'),          # its line: what the opening goes to
    ('k', 'f8'),                # of the open valve, m3/s/sqrt(Pa)
    ('left', 'f8'),             # share of the way to there that is left after a step,
    ('left_half', 'f8')])       # and after half of it
_FASTEST = 1.6 / SUPPLY_STEP    # 1/s: the fastest decay that a step can follow
_SMALLEST = 1e3                 # Pa, delta of V5 where the line is large


def dump_fields(sheet: NoneDump | LagDump | ValveDump, step: float) -> tuple[float, ...]:
    """Return the fields of a `DUMP` that opens in steps of ``step`` s."""
    if isinstance(sheet, NoneDump):
        return (0.0,) * len(DUMP.names or ())
    k = 0.0
    if isinstance(sheet, ValveDump):
        k = sheet.rated_lpm * LPM / math.sqrt(sheet.rated_drop_mpa * MPA)
    steps = step / (sheet.time_constant_ms * 1e-3)
    return 1.0, sheet.opened, k, exp(-steps), exp(-0.5 * steps)


@kernel
def opened_after(opening, left, dump):
    """Return the opening of which a share ``left`` of the way to its end is left  (C14)."""
    return dump.is_open + (opening - dump.is_open) * left


@kernel
def dumped(pressure, opening, elastance, dump):
    """
    Return the flow z K S(P) to the tank, in m3/s  (C14).

    ``elastance`` is dP/dV of the line, Pa/m3: the delta of V5 is such that a step can follow.
    """
    root = opening * dump.k * elastance / _FASTEST
    return opening * dump.k * signed_sqrt(pressure, max(_SMALLEST, root * root))
