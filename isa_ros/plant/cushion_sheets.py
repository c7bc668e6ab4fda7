"""
Data sheets of cushioned ends; `isa_ros.plant.cushion` has the equations.

What does not fit its cylinder is refused when all values are known, after those that scale.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.units import MILLI
from isa_ros.errors import ParameterError
from isa_ros.plant.drives import Cylinder

SHUT, OPEN = 1.0, 2.0
"""What `check_stuck` may be besides 0."""


@frozen(kw_only=True)
class NoneCushion(Parameters):
    """The port of the chamber is open up to the end."""


@frozen(kw_only=True)
class SpearCushion(Parameters):
    """A spear on the piston, or a sleeve around the rod, that closes the port near the end."""

    length_mm: float = parameter(
        'distance to the end at which the spear enters', 'mm', gt=0.0, le=500.0)
    spear_mm: float = parameter(
        'diameter of the spear, or of the sleeve around the rod', 'mm', gt=0.0, le=500.0)
    entry_mm: float = parameter(
        'travel over which the entering spear closes the port', 'mm', gt=0.0, le=500.0)
    port_lpm: float = parameter(
        'flow around the spear as it enters, at the rated drop', 'l/min', gt=0.0, le=1e4)
    restriction_lpm: float = parameter(
        'flow through the restriction at the rated drop', 'l/min', ge=0.0, le=1e3)
    check_lpm: float = parameter(
        'flow through the check valve at the rated drop beyond its opening', 'l/min',
        ge=0.0, le=1e4)
    check_opening_kpa: float = parameter(
        'drop that opens the check valve', 'kPa', absent=50.0, source='assumed',
        ge=0.0, le=1e3)
    rated_drop_mpa: float = parameter(
        'pressure drop at the stated flows', 'MPa', absent=7.0,
        source='assumed, as data sheets of valves state it', gt=0.0, le=70.0)
    trapped_ml: float = parameter(
        'oil behind the spear at the end, a part of the dead volume', 'ml', gt=0.0, le=1e4)
    check_stuck: float = fault(
        '1: the check valve does not open; 2: it does not close', '1', is_whole=True,
        ge=0.0, le=OPEN)
    restriction_blocked: float = fault(
        'share of the restriction that is blocked', '1', ge=0.0, le=1.0)


Cushion = NoneCushion | SpearCushion


def is_cushioned(plant: object) -> bool:
    """Return whether the sheet of a plant has a cushion; only cylinders may have any."""
    return any(isinstance(getattr(plant, name, None), SpearCushion)
               for name in ('cushion_a', 'cushion_b'))


def trapped_area(sheet: Cushion, bore_mm: float) -> float:
    """Return the area of a piston around its spear or sleeve in m2, 0 without one."""
    if isinstance(sheet, NoneCushion):
        return 0.0
    bore, spear = bore_mm * MILLI, sheet.spear_mm * MILLI
    return math.pi / 4.0 * (bore * bore - spear * spear)


def refuse_cushions(
        drive: Cylinder, cushion_a: Cushion, cushion_b: Cushion, dead_volume_ml: float) -> None:
    """
    Refuse cushions that do not fit their cylinder; the dead volume is that of a chamber, ml.

    Raises
    ------
    ParameterError
        A spear as thick as the piston, a sleeve no thicker than its rod, a port that is closed
        beyond the end, no dead volume at the port, or two that are longer than the stroke.

    """
    total = 0.0
    for name, own, rod in (('cushion_a', cushion_a, drive.cap_rod_mm),
                           ('cushion_b', cushion_b, drive.rod_mm)):
        if isinstance(own, NoneCushion):
            continue
        total += own.length_mm
        if not rod < own.spear_mm < drive.bore_mm:
            above = f'> {rod:g} mm, the rod there, and ' if rod > 0.0 else ''
            raise ParameterError(
                f'plant.{name}.spear_mm = {own.spear_mm:g} mm, must be {above}'
                f'< plant.drive.bore_mm = {drive.bore_mm:g} mm')
        if own.entry_mm > own.length_mm:
            raise ParameterError(
                f'plant.{name}.entry_mm = {own.entry_mm:g} mm, must be <= length_mm = '
                f'{own.length_mm:g} mm')
        if own.trapped_ml >= dead_volume_ml:
            raise ParameterError(
                f'plant.{name}.trapped_ml = {own.trapped_ml:g} ml, must be < '
                f'plant.oil.dead_volume_ml = {dead_volume_ml:g} ml, of which it is a part')
    if total >= drive.stroke_mm:
        raise ParameterError(
            f'length_mm of plant.cushion_a and plant.cushion_b = {total:g} mm together, must be '
            f'< plant.drive.stroke_mm = {drive.stroke_mm:g} mm')
