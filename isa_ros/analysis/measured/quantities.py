"""Quantities that a mapping may name, their units, and the signals of a run that they meet."""

from typing import NamedTuple

from isa_ros.core.suggest import listed
from isa_ros.core.units import NOT_SI, of_coordinate, Unit
from isa_ros.errors import ConfigError

BAR, PSI, INCH, POUND_FORCE = 1e5, 6894.757293168, 0.0254, 4.4482216152605
"""1 bar and 1 psi in Pa, 1 in in m, 1 lbf in N (exact by definition, psi = lbf / in2)."""

UNITS = {name: unit for name, unit in NOT_SI.items() if unit.si in (
    'm', 'rad', 'Pa', 'A', 's', 'm3/s', '1')} | {
    'bar': Unit('Pa', BAR), 'psi': Unit('Pa', PSI), 'kN': Unit('N', 1e3),
    'lbf': Unit('N', POUND_FORCE), 'in': Unit('m', INCH), 'mm/s': Unit('m/s', 1e-3)}
"""Units of measurements that are not SI."""


class Quantity(NamedTuple):
    """``unit`` in SI, of a linear | of a rotary actuator; ``field`` of a `SAMPLE`, '' for none."""

    unit: str
    field: str
    mode: str = ''
    """Of a command: the mode that it is the setpoint of."""
    setpoint: str = ''
    """Of a command: the field of `Setpoint`."""


QUANTITIES = {
    'position': Quantity('m | rad', 'position'),
    'velocity': Quantity('m/s | rad/s', 'velocity'),
    'force': Quantity('N | Nm', 'force'),
    'pressure_a': Quantity('Pa', 'pressure_a'),
    'pressure_b': Quantity('Pa', 'pressure_b'),
    'spool': Quantity('m', 'spool'),
    'current': Quantity('A', 'current'),
    'supply_pressure': Quantity('Pa', ''),
    'position_command': Quantity('m | rad', '', 'position', 'position'),
    'velocity_command': Quantity('m/s | rad/s', '', 'position', 'velocity'),
    'force_command': Quantity('N | Nm', '', 'force', 'effort'),
    'spool_command': Quantity('m', '', 'spool', 'spool'),
    'current_command': Quantity('A', '', 'current', 'current')}
"""Quantities by name; pressures are gauge."""


def scale_of(unit: str, quantity: Quantity, is_rotary: bool, where: str) -> float:
    """
    Return the SI units in one of a unit that is to be of a quantity.

    Raises
    ------
    ConfigError
        The unit is not of this quantity.

    """
    known = units_of(of_coordinate(quantity.unit, is_rotary))
    if unit not in known:
        raise ConfigError(f'{where}: unit = {unit!r}, must be one of {listed([*known])}')
    return known[unit]


def units_of(si: str) -> dict[str, float]:
    """Return the units of what has an SI unit, itself first, with the SI units in each."""
    return {si: 1.0} | {name: own.scale for name, own in UNITS.items() if own.si == si}
