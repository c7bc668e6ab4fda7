"""
A single-acting cylinder: pressure extends it, a spring in chamber B retracts it.

The lands of B are plugged; its port is open to the tank, or to the air through a breather, and
what the piston sweeps goes there. Forces of the spring are > 0 where it pushes in. Neglected: the
drop of that line, the mass of the spring, and that a breather lets out no leaked oil. One that
pulls against a spring in chamber A is not there.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, fault, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.errors import ParameterError
import numpy as np

TANK = 'tank'


@frozen(kw_only=True)
class NoneSpring(Parameters):
    """The valve feeds both chambers."""


@frozen(kw_only=True)
class CoilSpring(Parameters):
    """A spring in chamber B, whose port the valve does not feed."""

    preload: float = parameter('of the spring at the retracted end', 'N', ge=0.0, le=1e6)
    stiffness: float = parameter('of the spring', 'N/m', ge=0.0, le=1e8)
    open_to: str = choice(
        'where the port of chamber B leads: tank, the return line; breather, the air', TANK,
        'breather', absent=TANK, source='assumed')
    broken: float = fault(
        'share of its force that is gone; 1: the spring is broken', '1', ge=0.0, le=1.0)


Spring = NoneSpring | CoilSpring

SPRING = np.dtype([
    ('is_on', 'f8'),                            # 1: chamber B is open, whatever its spring
    ('preload', 'f8'), ('stiffness', 'f8'),     # N, N/m
    ('to_tank', 'f8')])                         # 1: B is open to the return; 0: to the air


def spring_record(sheet: Spring) -> np.record:
    """Return the `SPRING` record of a sheet."""
    if isinstance(sheet, NoneSpring):
        return record(SPRING, is_on=0.0, preload=0.0, stiffness=0.0, to_tank=0.0)
    sound = 1.0 - sheet.broken
    return record(
        SPRING, is_on=1.0, preload=sound * sheet.preload, stiffness=sound * sheet.stiffness,
        to_tank=float(sheet.open_to == TANK))


def spring_of(plant: object) -> Spring:
    """Return the spring of the sheet of a plant; none where only cylinders have one."""
    found: Spring = getattr(plant, 'return_spring', NoneSpring())
    return found


def spring_forces(sheet: Spring, stroke: float) -> tuple[float, float]:
    """Return the forces of a sound spring at the retracted and the extended end, N."""
    if isinstance(sheet, NoneSpring):
        return 0.0, 0.0
    return sheet.preload, sheet.preload + sheet.stiffness * stroke


def refuse_spring(sheet: Spring, area_a: float, rated_pressure: float, stroke: float) -> None:
    """
    Refuse a spring that the rated pressure (Pa) on the piston (m2) does not push to its end (m).

    Raises
    ------
    ParameterError
        F_0 + k L is not less than A_A P_S.

    """
    most, held = spring_forces(sheet, stroke)[1], area_a * rated_pressure
    if most >= held:
        raise ParameterError(
            f'plant.return_spring: preload + stiffness * stroke = {most:g} N at the extended end, '
            f'must be < {held:g} N, plant.drive.rated_pressure_mpa on the piston')


@kernel
def spring_force(s, spring):
    """Return F_0 + k s, which pushes in  (M5), in N."""
    return spring.preload + spring.stiffness * s


@kernel
def vent_pressure(p_t, spring):
    """Return the pressure at which chamber B is open, that of the tank or 0, in Pa gauge."""
    return p_t if spring.to_tank > 0.0 else 0.0


@kernel
def vented(p, vent, surplus, elastance):
    """
    Return the flow out of an open chamber at a pressure ``p``, in m3/s  (C33).

    All that it gains, but for what lets its pressure follow that of its port, ``vent``, at
    `FASTEST_RATE`. Oil that boils has no elastance: then it gains nothing.
    """
    if elastance <= 0.0:
        return surplus
    return surplus - FASTEST_RATE * (vent - p) / elastance
