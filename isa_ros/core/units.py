"""Units of data sheets in SI, and units of linear and rotary actuators."""

import math
from typing import NamedTuple

LPM = 1e-3 / 60.0  # 1 l/min in m3/s
MPA = 1e6          # 1 MPa in Pa
MILLI = 1e-3       # 1 mm in m, 1 mA in A
MICRO = 1e-6       # 1 um in m, 1 uA in A
LITRE = 1e-3       # 1 l in m3
PERCENT = 0.01
MILLILITRE = 1e-6  # 1 ml in m3


class Unit(NamedTuple):
    """One unit of data sheets: ``factor`` over ``divisor`` of the SI unit."""

    si: str
    factor: float
    divisor: float = 1.0

    @property
    def scale(self) -> float:
        """Return the number of SI units in one."""
        return self.factor / self.divisor


NOT_SI = {
    'mm': Unit('m', MILLI), 'um': Unit('m', MICRO), 'mm2/s': Unit('m2/s', MICRO),
    'l': Unit('m3', LITRE), 'ml': Unit('m3', MILLILITRE), 'ml/m': Unit('m2', MILLILITRE),
    'cc/rad': Unit('m3/rad', MILLILITRE),
    'MPa': Unit('Pa', MPA), 'kPa': Unit('Pa', 1e3), 'deg': Unit('rad', math.radians(1.0)),
    'ms': Unit('s', MILLI), 'us': Unit('s', MICRO), 'mA': Unit('A', MILLI),
    'l/min': Unit('m3/s', LPM), 'l/min/MPa': Unit('m3/s/Pa', LPM, MPA),
    'l/min/mA': Unit('m3/s/A', LPM, MILLI), 'mm/mA': Unit('m/A', MILLI, MILLI),
    'mm/s/mA': Unit('m/s/A', MILLI, MILLI), 'mA/MPa': Unit('A/Pa', MILLI, MPA),
    'uA/K': Unit('A/K', MICRO), 'V/mA': Unit('V/A', 1.0, MILLI),
    'V/(mA s)': Unit('V/(A s)', 1.0, MILLI), 'V s/mA': Unit('V s/A', 1.0, MILLI),
    '%': Unit('1', PERCENT), '%/MPa': Unit('1/Pa', PERCENT, MPA), '%/K': Unit('1/K', PERCENT),
    'rpm': Unit('Hz', 1.0, 60.0), 'MB': Unit('B', MPA), 'Mbit/s': Unit('bit/s', MPA)}
"""All units of data sheets that are not SI. Hz is; rad/s is 2 pi of it, by the equation."""
_SI = frozenset((
    '1', '1/K', '1/Pa', '1/s', '1/s2', 'A', 'A/s', 'H', 'Hz', 'J', 'J/(kg K)', 'J/K', 'K', 'K/s',
    'N', 'N s/m', 'N/m', 'N/m^1.5', 'N/s', 'Nm', 'Nm/rad', 'Nm/s', 'Nms/rad', 'Ns/m', 'Pa', 'Pa/s',
    'V', 'W', 'W/K', 'bit', 'celsius', 'bits', 'cycles', 'frames', 'kg', 'kg m2', 'kg/m3', 'm',
    'm/m',
    'm/rad', 'm/s', 'm/s2', 'm3', 'm3/s', 'm3/s/Pa', 'ohm', 'rad', 'rad/s', 'rad/s2', 's', 's/m',
    'output', 'output per m/s', 'output per rad/s', 'output s/measured', 'output/(measured s)',
    'output/measured'))
"""All others; output and measured are those of a control block."""


def in_si(unit: str) -> Unit:
    """
    Return a unit, of a linear ``|`` of a rotary actuator, in SI.

    Raises
    ------
    ValueError
        It is in neither list.

    """
    if unit in NOT_SI:
        return NOT_SI[unit]
    if not _SI.issuperset(unit.split(' | ')):
        raise ValueError(f'unit {unit!r} is not in isa_ros.core.units')
    return Unit(unit, 1.0)


def after(separator: str, unit: str) -> str:
    """Return a separator and a unit; nothing where there is no dimension: '1' or ''."""
    return '' if unit in ('', '1') else f'{separator}{unit}'


def quantity(value: str, unit: str) -> str:
    """Return a value with its unit, if it has a dimension."""
    return f'{value}{after(" ", unit)}'


def of_coordinate(unit: str, is_rotary: bool) -> str:
    """Return the linear or the rotary alternative of a unit ``linear | rotary``."""
    linear, _, rotary = unit.partition(' | ')
    return rotary if rotary and is_rotary else linear
